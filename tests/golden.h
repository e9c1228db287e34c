#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "core/base/picture_io.h"

namespace homolog::test {

/// Share of pixels that differ visibly; 1 where the sizes do.
inline double differing_share(const Picture& a, const Picture& b) {
  constexpr int kVisible = 12;
  if (a.width != b.width || a.height != b.height) return 1;
  std::size_t differing = 0;
  for (std::size_t i = 0; i < a.rgba.size(); i += 4) {
    int largest = 0;
    for (std::size_t k = i; k < i + 4; ++k) largest = std::max(largest, std::abs(a.rgba[k] - b.rgba[k]));
    differing += largest > kVisible;
  }
  return 4.0 * static_cast<double>(differing) / static_cast<double>(a.rgba.size());
}

/// Compares a picture with tests/golden/NAME.png. CPUs and drivers round differently: 1.5 % of the pixels may differ.
inline void check_golden(const Picture& picture, const std::string& name) {
  const std::filesystem::path golden = std::filesystem::path(HOMOLOG_SOURCE_DIR) / "tests/golden" / (name + ".png");
  const std::filesystem::path drawn = std::filesystem::path(HOMOLOG_BINARY_DIR) / "golden" / (name + ".png");
  const Result<Picture> expected = read_picture(golden);
  const double share = expected ? differing_share(picture, *expected) : 1;
  if (share <= 0.015) return;
  std::filesystem::create_directories(drawn.parent_path());
  const auto written = write_picture(picture, drawn);
  const std::string what = expected ? std::to_string(100 * share) + " % of its pixels differ from the golden picture"
                                    : "there is no golden picture of it";
  FAIL(what << "; look at " << (written ? drawn.string() : written.error().sentence())
            << " and, if it is right, copy it to " << golden.string());
}

}  // namespace homolog::test
