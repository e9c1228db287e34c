#include "core/volume/dicom/dicom_copies.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <string_view>

namespace homolog {
namespace fs = std::filesystem;

namespace {

/// The runs of bytes of a file's pixels; compressed ones up to the file's end.
std::vector<DicomPixels::Fragment> pixel_runs(const DicomHeader& header) {
  const DicomPixels& pixels = *header.pixels;
  if (!pixels.fragments.empty()) return pixels.fragments;
  std::error_code ignored;
  const std::uintmax_t size = fs::file_size(header.path, ignored);
  std::uint64_t left = pixels.bytes;
  if (pixels.block.compression != Compression::None) left = ignored ? 0 : size - pixels.block.offset;
  return {{pixels.block.offset, static_cast<std::uint32_t>(left)}};
}

bool same_bytes(std::istream& a, std::istream& b, std::uint64_t count) {
  std::array<char, 65536> of_a, of_b;
  while (count > 0) {
    const auto piece = static_cast<std::streamsize>(std::min<std::uint64_t>(count, of_a.size()));
    if (!a.read(of_a.data(), piece) || !b.read(of_b.data(), piece)) return false;
    if (!std::equal(of_a.begin(), of_a.begin() + piece, of_b.begin())) return false;
    count -= static_cast<std::uint64_t>(piece);
  }
  return true;
}

bool same_pixels(const DicomHeader& a, const DicomHeader& b) {
  const auto in_a = pixel_runs(a), in_b = pixel_runs(b);
  if (in_a.size() != in_b.size() || a.transfer_syntax != b.transfer_syntax) return false;
  std::ifstream file_a(a.path, std::ios::binary), file_b(b.path, std::ios::binary);
  for (std::size_t r = 0; r < in_a.size(); ++r) {
    if (in_a[r].bytes != in_b[r].bytes) return false;
    file_a.seekg(static_cast<std::streamoff>(in_a[r].offset));
    file_b.seekg(static_cast<std::streamoff>(in_b[r].offset));
    if (!same_bytes(file_a, file_b, in_a[r].bytes)) return false;
  }
  return true;
}

bool is_copy(const DicomHeader& a, const DicomHeader& b) {
  const auto same_plane = [](const DicomPlane& one, const DicomPlane& other) {
    return one.position_mm == other.position_mm && one.times == other.times && one.rescale == other.rescale;
  };
  return a.instance_number == b.instance_number && a.rows == b.rows && a.columns == b.columns &&
         std::equal(a.planes.begin(), a.planes.end(), b.planes.begin(), b.planes.end(), same_plane) &&
         same_pixels(a, b);
}

}  // namespace

std::vector<DicomHeader> without_copies(const fs::path& path, const std::vector<DicomHeader>& headers,
                                        std::vector<std::string>& warnings) {
  std::vector<DicomHeader> kept;
  std::multimap<std::string_view, const DicomHeader*> by_uid;
  std::string example;
  for (const DicomHeader& header : headers) {
    const auto [first, last] = by_uid.equal_range(header.instance_uid);
    const auto original = std::find_if(first, last, [&](const auto& one) { return is_copy(*one.second, header); });
    if (original != last) {
      if (example.empty())
        example = header.path.filename().string() + " is a copy of " + original->second->path.filename().string();
      continue;
    }
    if (!header.instance_uid.empty()) by_uid.emplace(header.instance_uid, &header);
    kept.push_back(header);
  }
  const std::size_t copies = headers.size() - kept.size();
  if (copies > 0)
    warnings.push_back(path.string() + ": holds " + std::to_string(copies) + (copies == 1 ? " slice" : " slices") +
                       " twice (" + example + "); one of each is read");
  return kept;
}

}  // namespace homolog
