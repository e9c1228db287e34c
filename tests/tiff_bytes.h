#pragma once

#include <doctest/doctest.h>
#include <zlib.h>

#include <string>
#include <vector>

#include "tests/temporary_folder.h"

namespace homolog {

/// Packed as zlib does, for strips of a TIFF and rows of a PNG.
inline std::string deflated(const std::string& bytes) {
  std::string packed(compressBound(bytes.size()), '\0');
  uLongf size = packed.size();
  REQUIRE(compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                   bytes.size()) == Z_OK);
  packed.resize(size);
  return packed;
}

/// A TIFF file made byte by byte [TIFF 6.0, §2]: little-endian, each page's pixels behind its table. Members that tests
/// change.
struct TiffBytes {
  std::uint32_t width = 4, height = 2;
  std::uint32_t bits = 8, format = 1, samples = 1, compression = 1, photometric = 1, orientation = 1, planes = 1;
  std::uint32_t rows_per_strip = 0;               ///< 0: one strip a page
  std::uint32_t tile_width = 0, tile_height = 0;  ///< 0: strips
  bool alpha = false;
  std::string description;
  std::vector<std::vector<std::string>> pages;  ///< strips or tiles of each page, as they are stored
  std::uint32_t last_link = 0;                  ///< the place that the last page's link points to

  std::string bytes() const {
    std::string text = "II" + little_endian(42, 2) + little_endian(8, 4);
    for (std::size_t p = 0; p < pages.size(); ++p) {
      const std::string page = page_bytes(static_cast<std::uint32_t>(text.size()), pages[p], p + 1 == pages.size());
      text += page;
    }
    return text;
  }

 private:
  static constexpr std::uint32_t is_ascii = 2, is_short = 3, is_long = 4;

  static std::string entry(std::uint32_t tag, std::uint32_t type, std::uint32_t count, std::uint32_t value) {
    return little_endian(tag, 2) + little_endian(type, 2) + little_endian(count, 4) + little_endian(value, 4);
  }

  std::string page_bytes(std::uint32_t begin, const std::vector<std::string>& pieces, bool last) const {
    const bool tiled = tile_width > 0, many = pieces.size() > 1;
    const auto count = static_cast<std::uint32_t>(pieces.size());
    const std::uint32_t entries = 14u + (tiled ? 1 : 0) + (alpha ? 1 : 0) + (description.empty() ? 0 : 1);
    const std::uint32_t behind = begin + 2 + 12 * entries + 4, lists = many ? 8 * count : 0;
    const std::uint32_t text_at = behind + lists, text_bytes = description.empty() ? 0 : size_of(description) + 1;
    std::vector<std::uint32_t> offsets{text_at + text_bytes};
    for (const std::string& piece : pieces) offsets.push_back(offsets.back() + size_of(piece));
    const std::uint32_t at = many ? behind : offsets[0], sizes_at = many ? behind + 4 * count : size_of(pieces[0]);
    std::string text = little_endian(entries, 2);
    text += entry(254, is_long, 1, 0) + entry(256, is_long, 1, width) + entry(257, is_long, 1, height) +
            entry(258, is_short, 1, bits) + entry(259, is_short, 1, compression) + entry(262, is_short, 1, photometric);
    if (!description.empty()) text += entry(270, is_ascii, text_bytes, text_at);
    if (!tiled) text += entry(273, is_long, count, at);
    text += entry(274, is_short, 1, orientation) + entry(277, is_short, 1, samples);
    if (!tiled)
      text +=
          entry(278, is_long, 1, rows_per_strip > 0 ? rows_per_strip : height) + entry(279, is_long, count, sizes_at);
    text += entry(284, is_short, 1, planes);
    if (tiled)
      text += entry(322, is_long, 1, tile_width) + entry(323, is_long, 1, tile_height) +
              entry(324, is_long, count, at) + entry(325, is_long, count, sizes_at);
    if (alpha) text += entry(338, is_short, 1, 2);
    text += entry(339, is_short, 1, format) + entry(65000, is_short, 1, 7);
    text += little_endian(last ? last_link : offsets.back(), 4);
    if (many) {
      for (std::size_t s = 0; s < count; ++s) text += little_endian(offsets[s], 4);
      for (const std::string& piece : pieces) text += little_endian(size_of(piece), 4);
    }
    if (!description.empty()) text += description + '\0';
    for (const std::string& piece : pieces) text += piece;
    return text;
  }

  static std::uint32_t size_of(const std::string& bytes) { return static_cast<std::uint32_t>(bytes.size()); }
};

}  // namespace homolog
