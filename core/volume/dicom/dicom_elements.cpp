#include "core/volume/dicom/dicom_elements.h"

#include <cstdio>
#include <string_view>

namespace homolog {

namespace {

std::string lowest_bytes(std::uint64_t value, int bytes) {
  std::string text;
  for (int b = 0; b < bytes; ++b) text += static_cast<char>(value >> 8 * b & 0xff);
  return text;
}

/// A number in at most 16 characters, as near as they allow.
std::string decimal_string(double value) {
  char text[64];
  for (int digits = 15; digits > 0; --digits)
    if (std::snprintf(text, sizeof text, "%.*g", digits, value + 0.0) <= 16) break;
  return text;
}

}  // namespace

DicomElements& DicomElements::put(DicomTag tag, const char* vr, const std::string& value) {
  constexpr std::string_view long_lengths = "OB OW SQ UN UT", zero_padded = "UI OB OW";
  const bool has_long_length = long_lengths.find(vr) != std::string_view::npos;
  const std::size_t most = has_long_length ? 0xfffffffe : 0xfffe;
  if (value.size() > most) {
    if (!too_long_) too_long_ = tag;
    return put(tag, vr, "");
  }
  const auto size = value.size() + value.size() % 2;
  std::string& out = elements_[tag];
  out = lowest_bytes(tag >> 16, 2) + lowest_bytes(tag & 0xffff, 2) + vr;
  if (has_long_length)
    out += std::string(2, '\0') + lowest_bytes(size, 4);
  else
    out += lowest_bytes(size, 2);
  out += value;
  if (size != value.size()) out += zero_padded.find(vr) != std::string_view::npos ? '\0' : ' ';
  return *this;
}

DicomElements& DicomElements::put_shorts(DicomTag tag, const std::vector<std::uint16_t>& values) {
  std::string text;
  for (const std::uint16_t value : values) text += lowest_bytes(value, 2);
  return put(tag, "US", text);
}

DicomElements& DicomElements::put_longs(DicomTag tag, const std::vector<std::uint32_t>& values) {
  std::string text;
  for (const std::uint32_t value : values) text += lowest_bytes(value, 4);
  return put(tag, "UL", text);
}

DicomElements& DicomElements::put_decimals(DicomTag tag, const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : "\\") + decimal_string(value);
  return put(tag, "DS", text);
}

DicomElements& DicomElements::put_tag(DicomTag tag, DicomTag value) {
  return put(tag, "AT", lowest_bytes(value >> 16, 2) + lowest_bytes(value & 0xffff, 2));
}

DicomElements& DicomElements::put_items(DicomTag tag, const std::vector<DicomElements>& items) {
  std::string text;
  for (const DicomElements& one : items) {
    if (!too_long_) too_long_ = one.too_long_;
    const std::string content = one.bytes();
    text += lowest_bytes(0xfffe, 2) + lowest_bytes(0xe000, 2) + lowest_bytes(content.size(), 4) + content;
  }
  return put(tag, "SQ", text);
}

Result<void> DicomElements::check() const {
  if (!too_long_) return {};
  char name[16];
  std::snprintf(name, sizeof name, "(%04x,%04x)", *too_long_ >> 16, *too_long_ & 0xffff);
  return fail("",
              std::string("cannot be written: the element ") + name +
                  " is longer than DICOM allows (65,534 bytes of a text); shorten it in the series or the label map");
}

std::string DicomElements::bytes() const {
  std::string text;
  for (const auto& [tag, element] : elements_) text += element;
  return text;
}

}  // namespace homolog
