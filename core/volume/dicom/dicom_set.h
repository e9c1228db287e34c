#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/volume/voxel_stream.h"

namespace homolog {

/// (group, element) as one number: 0x00280010 for (0028,0010).
using DicomTag = std::uint32_t;

struct DicomElement;
using DicomItem = std::map<DicomTag, DicomElement>;

/// A value of up to 64 KiB as it lies in the file (a palette: of up to 128 KiB, the points of a contour: of any
/// length), or the items of a sequence.
struct DicomElement {
  std::string value;
  std::vector<DicomItem> items;
};

/// The place of the pixels in a file.
struct DicomPixels {
  struct Fragment {
    std::uint64_t offset = 0;
    std::uint32_t bytes = 0;
  };
  ByteBlock block;  ///< the pixels, if they are not encoded
  std::uint64_t bytes = 0;
  std::vector<Fragment> fragments;  ///< the encoded pixels; none where they are not encoded
};

/// The structure of a DICOM file, checked to its last byte: every element lies within the file.
struct DicomSet {
  std::filesystem::path path;
  std::string transfer_syntax;
  bool big_endian = false;
  DicomItem elements;
  std::optional<DicomPixels> pixels;
};

/// Whether a file bears DICOM's mark or its extension .dcm, or begins as an unmarked data set.
bool looks_like_dicom(const std::filesystem::path& path);

/// Parses a file's structure [DICOM PS3.5 §7, PS3.10 §7] without reading its pixels. Fails where it is no DICOM file,
/// ends within an element, or has a transfer syntax that is not the standard's. GDCM does not parse files here: it
/// aborts on many damaged ones.
Result<DicomSet> parse_dicom(const std::filesystem::path& path);

/// A text value without its padding; empty where it is missing.
std::string text_of(const DicomItem& item, DicomTag tag);

/// The numbers of a decimal or integer string (DS, IS); empty where it is missing or damaged.
std::vector<double> numbers_of(const DicomItem& item, DicomTag tag);

/// The first of these numbers.
std::optional<double> number_of(const DicomItem& item, DicomTag tag);

/// A binary value of two or four bytes (US, UL) or eight (FD), by its length.
std::optional<double> binary_number_of(const DicomItem& item, DicomTag tag, bool big_endian);

/// The item of a sequence, counted from 0; null where there is none.
const DicomItem* item_of(const DicomItem& item, DicomTag sequence, std::size_t index);

/// The elements that describe one aspect of one plane: those of the plane's functional group, else of the group shared
/// by all, else of the file itself [DICOM PS3.3, C.7.6.16].
const DicomItem& aspect_of(const DicomItem& data, std::size_t plane, DicomTag aspect);

/// The plane's own functional group of that kind; null where it has none.
const DicomItem* own_aspect(const DicomItem& data, std::size_t plane, DicomTag aspect);

}  // namespace homolog
