#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/editor/widgets/drawn_items.h"
#include "render/offscreen.h"
#include "tests/golden.h"
#include "tests/skip.h"

// Pictures of whole screens.

namespace homolog::test {

/// A context that draws without a display; null, and the test is skipped, where there is none.
inline std::unique_ptr<OffscreenContext> context_or_skip() {
  auto gl = OffscreenContext::make();
  if (gl) return std::move(*gl);
  skip(gl.error().sentence());
  return nullptr;
}

/// Every control and text by itself: a word covers a tenth of its rectangle. `smaller`: how many px of the window are
/// one of the picture.
inline void add_items(std::vector<PicturePart>& parts, const std::vector<DrawnItem>& items, const Picture& picture,
                      float smaller = 1) {
  const float smallest_px2 = 40 / smaller / smaller;
  constexpr double limit = 0.03;
  for (const DrawnItem& item : items) {
    const float x = item.seen.x / smaller, y = item.seen.y / smaller;
    const float width = item.seen.width / smaller, height = item.seen.height / smaller;
    if (width * height < smallest_px2 || item.kind == DrawnItem::Kind::area) continue;
    parts.push_back(part_in(item.path, picture, x, y, width, height, limit));
  }
}

/// Half as wide and high: each pixel the mean of four. A fourth of the bytes, and every word is still to be seen.
inline Picture halved(const Picture& picture) {
  Picture half;
  half.width = picture.width / 2;
  half.height = picture.height / 2;
  half.rgba.resize(4 * static_cast<std::size_t>(half.width) * static_cast<std::size_t>(half.height));
  const auto row = 4 * static_cast<std::size_t>(picture.width);
  for (std::size_t y = 0; y < static_cast<std::size_t>(half.height); ++y)
    for (std::size_t x = 0; x < static_cast<std::size_t>(half.width); ++x)
      for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t from = 2 * y * row + 8 * x + k;
        const int sum =
            picture.rgba[from] + picture.rgba[from + 4] + picture.rgba[from + row] + picture.rgba[from + row + 4];
        half.rgba[4 * (y * static_cast<std::size_t>(half.width) + x) + k] = static_cast<std::uint8_t>((sum + 2) / 4);
      }
  return half;
}

}  // namespace homolog::test
