#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/base/pictures/picture_io.h"

// Pictures are compared with those in tests/golden, part by part: an outline covers 1 % of a picture, and a limit for
// the whole would not see it go. CPUs and drivers round differently, so that every part has a limit of its own.

namespace homolog::test {

/// By how much a pixel's value may differ before it counts.
inline constexpr int faint_difference = 12, plain_difference = 48;

/// Which pixels of a picture, one entry a pixel.
using PixelMask = std::vector<bool>;

inline std::size_t count_of(const PixelMask& mask) {
  return static_cast<std::size_t>(std::count(mask.begin(), mask.end(), true));
}

/// Pixels in which two pictures of one size differ by more than that in any channel.
inline PixelMask differing_pixels(const Picture& a, const Picture& b, int more_than) {
  PixelMask mask(a.rgba.size() / 4);
  for (std::size_t i = 0; i < mask.size(); ++i)
    for (std::size_t k = 4 * i; k < 4 * i + 4; ++k)
      if (std::abs(a.rgba[k] - b.rgba[k]) > more_than) mask[i] = true;
  return mask;
}

/// A part of a picture that is compared by itself: its outlines, its glyphs, a word.
struct PicturePart {
  std::string name;
  PixelMask pixels;
  double limit = 0.05;  ///< share of its pixels that may differ
  int difference = plain_difference;
};

/// The part that `picture` shows and `without` does not.
inline PicturePart part_drawn(std::string name, const Picture& picture, const Picture& without, double limit = 0.05) {
  return {std::move(name), differing_pixels(picture, without, plain_difference), limit};
}

/// A rectangle, px from the upper left corner.
inline PicturePart part_in(std::string name, const Picture& picture, float x, float y, float width, float height,
                           double limit) {
  PicturePart part{std::move(name), PixelMask(picture.rgba.size() / 4), limit};
  const auto clamped = [](float value, int most) { return std::clamp(static_cast<int>(value), 0, most); };
  for (int row = clamped(y, picture.height); row < clamped(y + height, picture.height); ++row)
    for (int column = clamped(x, picture.width); column < clamped(x + width, picture.width); ++column)
      part.pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(picture.width) +
                  static_cast<std::size_t>(column)] = true;
  return part;
}

/// The faults of a picture where `golden` is right: one line a part; empty where nothing is. What belongs to no
/// part is "the rest", of which 0.5 % may differ.
inline std::string golden_fault(const Picture& picture, const Picture& golden, std::vector<PicturePart> parts) {
  constexpr std::size_t fewest = 20;  // pixels of a part that is there
  constexpr double limit_of_rest = 0.005;
  if (picture.width != golden.width || picture.height != golden.height) return "its size is another\n";
  PicturePart rest{"the rest", PixelMask(picture.rgba.size() / 4, true), limit_of_rest, faint_difference};
  for (const PicturePart& part : parts)
    for (std::size_t i = 0; i < rest.pixels.size(); ++i)
      if (part.pixels[i]) rest.pixels[i] = false;
  parts.push_back(std::move(rest));
  std::string faults;
  std::map<int, PixelMask> differing_by_more;
  for (const PicturePart& part : parts) {
    const std::size_t all = count_of(part.pixels);
    if (all < fewest) faults += part.name + ": is not drawn\n";
    PixelMask& differing = differing_by_more[part.difference];
    if (differing.empty()) differing = differing_pixels(picture, golden, part.difference);
    std::size_t count = 0;
    for (std::size_t i = 0; i < differing.size(); ++i) count += differing[i] && part.pixels[i];
    const double share = static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(all, 1));
    if (share > part.limit) faults += part.name + ": " + std::to_string(100 * share) + " % of its pixels differ\n";
  }
  return faults;
}

/// Compares a picture with tests/golden/NAME.png; where it is another, leaves it in the build's folder to look at.
inline void check_golden(const Picture& picture, const std::string& name, const std::vector<PicturePart>& parts) {
  const std::filesystem::path golden = std::filesystem::path(HOMOLOG_SOURCE_DIR) / "tests/golden" / (name + ".png");
  const std::filesystem::path drawn = std::filesystem::path(HOMOLOG_BINARY_DIR) / "golden" / (name + ".png");
  const Result<Picture> expected = read_picture(golden);
  const std::string fault = expected ? golden_fault(picture, *expected, parts) : "there is no golden picture of it\n";
  if (fault.empty()) return;
  std::filesystem::create_directories(drawn.parent_path());
  const auto written = write_picture(picture, drawn);
  FAIL(name << ":\n"
            << fault << "look at " << (written ? drawn.string() : written.error().sentence())
            << " and, if it is right, copy it to " << golden.string());
}

}  // namespace homolog::test
