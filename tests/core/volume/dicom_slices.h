#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/volume/volume_io.h"
#include "tests/temporary_folder.h"

// DICOM files of a few pixels, byte by byte.
namespace homolog {

/// An element with explicit type and little-endian numbers [DICOM PS3.5, §7.1.2].
inline std::string element(std::uint32_t tag, const std::string& type, std::string value) {
  if (value.size() % 2 != 0) value += type == "UI" || type == "OW" ? '\0' : ' ';
  const auto size = static_cast<std::uint32_t>(value.size());
  const bool long_form = type == "OW" || type == "SQ";
  return little_endian(tag >> 16, 2) + little_endian(tag & 0xffff, 2) + type +
         (long_form ? std::string(2, '\0') + little_endian(size, 4) : little_endian(size, 2)) + value;
}

inline std::string us(std::uint32_t tag, std::uint32_t value) {
  return element(tag, "US", little_endian(value, 2));
}

inline std::string item(const std::string& content) {
  return little_endian(0xfffe, 2) + little_endian(0xe000, 2) +
         little_endian(static_cast<std::uint32_t>(content.size()), 4) + content;
}

inline std::string sequence(std::uint32_t tag, const std::string& items) {
  return element(tag, "SQ", items);
}

inline std::string position(double x, double y, double z) {
  return element(0x00200032, "DS", std::to_string(x) + "\\" + std::to_string(y) + "\\" + std::to_string(z));
}

/// A slice of 3 × 2 pixels of 16 bits; members that tests change.
struct Slice {
  std::string series = "1.2.3", description = "axial", modality = "CT", orientation = "1\\0\\0\\0\\1\\0";
  double x = 0, y = 0, z = 0;
  std::string before_pixels;                  ///< further elements of groups between 0028,0103 and 7fe0
  std::string frames;                         ///< number of frames
  std::map<std::uint32_t, std::string> more;  ///< elements by their tags, in place of those that are there
  std::optional<double> trigger_ms;
  int instance = 1, columns = 3, bits_stored = 16, is_signed = 1, samples = 1;
  std::string photometric = "MONOCHROME2";
  std::vector<std::int16_t> pixels{0, 1, 2, 3, 4, 5};
  std::string syntax = "1.2.840.10008.1.2.1";
  std::vector<std::string> fragments;  ///< encoded planes instead of `pixels`

  std::string bytes() const {
    const std::string pixel_bytes(reinterpret_cast<const char*>(pixels.data()), 2 * pixels.size());
    std::map<std::uint32_t, std::string> elements = more;
    const auto put = [&elements](std::uint32_t tag, const std::string& bytes) { elements.emplace(tag, bytes); };
    put(0x00080060, element(0x00080060, "CS", modality));
    put(0x0008103e, element(0x0008103e, "LO", description));
    if (trigger_ms) put(0x00181060, element(0x00181060, "DS", std::to_string(*trigger_ms)));
    put(0x0020000e, element(0x0020000e, "UI", series));
    put(0x00200013, element(0x00200013, "IS", std::to_string(instance)));
    if (!orientation.empty()) put(0x00200032, position(x, y, z));
    if (!orientation.empty()) put(0x00200037, element(0x00200037, "DS", orientation));
    put(0x00280002, us(0x00280002, static_cast<std::uint32_t>(samples)));
    put(0x00280004, element(0x00280004, "CS", photometric));
    if (!frames.empty()) put(0x00280008, element(0x00280008, "IS", frames));
    put(0x00280010, us(0x00280010, 2));
    put(0x00280011, us(0x00280011, static_cast<std::uint32_t>(columns)));
    put(0x00280030, element(0x00280030, "DS", "0.5\\0.25"));
    put(0x00280100, us(0x00280100, 16));
    put(0x00280101, us(0x00280101, static_cast<std::uint32_t>(bits_stored)));
    put(0x00280102, us(0x00280102, static_cast<std::uint32_t>(bits_stored - 1)));
    put(0x00280103, us(0x00280103, static_cast<std::uint32_t>(is_signed)));
    std::string data, behind;
    for (const auto& [tag, bytes] : elements) (tag < 0x52000000 ? data : behind) += bytes;
    data += before_pixels + behind + (fragments.empty() ? element(0x7fe00010, "OW", pixel_bytes) : encoded());
    const std::string meta = element(0x00020010, "UI", syntax);
    return std::string(128, '\0') + "DICM" +
           element(0x00020000, "UL", little_endian(static_cast<std::uint32_t>(meta.size()), 4)) + meta + data;
  }

  /// Adds an element, or puts it in the place of one that every slice has.
  void put(std::uint32_t tag, const std::string& type, const std::string& value) {
    more[tag] = element(tag, type, value);
  }

  /// The pixels in fragments behind an empty table of offsets [DICOM PS3.5, §A.4].
  std::string encoded() const {
    std::string data = little_endian(0x7fe0, 2) + little_endian(0x0010, 2) + "OB" + std::string(2, '\0') +
                       little_endian(0xffffffff, 4) + item("");
    for (const std::string& fragment : fragments) data += item(fragment);
    return data + little_endian(0xfffe, 2) + little_endian(0xe0dd, 2) + little_endian(0, 4);
  }
};

/// Slices 2.5 mm apart whose files are named in another order than they lie.
inline void save_series(const std::filesystem::path& folder, const std::vector<double>& z, Slice slice = {}) {
  for (std::size_t s = 0; s < z.size(); ++s) {
    slice.z = z[s];
    slice.instance = static_cast<int>(s);
    for (auto& pixel : slice.pixels) pixel = static_cast<std::int16_t>(10 * z[s]);
    write_bytes(folder / (slice.series + "-" + std::to_string((s * 7) % 100) + ".dcm"), slice.bytes());
  }
}

inline Result<VolumeRead> read_slice(const Slice& slice) {
  const TemporaryFolder folder;
  write_bytes(folder.path / "slice.dcm", slice.bytes());
  return read_volume(folder.path / "slice.dcm");
}

}  // namespace homolog
