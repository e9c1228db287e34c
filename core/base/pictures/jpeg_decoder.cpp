#include <gdcmImage.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>

#include <cstdint>

#include "core/base/pictures/picture_readers.h"

// Through GDCM, the library behind ITK's reader. Only its decoders of the JPEG family are used: its parser fills
// missing pixels with zeros and, as Debian builds it, aborts the program on damaged files. Its run-length decoder
// trusts every header.
namespace homolog {
namespace {

void silence_gdcm() {
  gdcm::Trace::DebugOff();
  gdcm::Trace::WarningOff();
  gdcm::Trace::ErrorOff();
}

/// A picture that is given to GDCM without its file.
gdcm::Image empty_image(const JpegPlane& plane, gdcm::TransferSyntax::TSType syntax) {
  gdcm::Image image;
  image.SetTransferSyntax(syntax);
  image.SetNumberOfDimensions(2);
  image.SetDimension(0, static_cast<unsigned>(plane.columns));
  image.SetDimension(1, static_cast<unsigned>(plane.rows));
  const auto bits = [](int count) { return static_cast<unsigned short>(count); };
  image.SetPixelFormat(gdcm::PixelFormat(1, bits(plane.bits_allocated), bits(plane.bits_stored), bits(plane.high_bit),
                                         plane.is_signed ? 1 : 0));
  image.SetPhotometricInterpretation(gdcm::PhotometricInterpretation::MONOCHROME2);
  return image;
}

}  // namespace

bool decode_jpeg(const JpegPlane& plane, std::span<const char> stream, std::span<std::byte> out) {
  const auto syntax = gdcm::TransferSyntax::GetTSType(plane.transfer_syntax.c_str());
  if (syntax == gdcm::TransferSyntax::TS_END) return false;
  gdcm::Fragment fragment;
  fragment.SetByteValue(stream.data(), gdcm::VL(static_cast<std::uint32_t>(stream.size())));
  const auto sequence = gdcm::SequenceOfFragments::New();
  sequence->AddFragment(fragment);
  gdcm::DataElement pixels(gdcm::Tag(0x7fe0, 0x0010), gdcm::VL(0xffffffff), gdcm::VR::OB);
  pixels.SetValue(*sequence);
  gdcm::Image image = empty_image(plane, syntax);
  image.SetDataElement(pixels);
  silence_gdcm();
  return image.GetBufferLength() == out.size() && image.GetBuffer(reinterpret_cast<char*>(out.data()));
}

}  // namespace homolog
