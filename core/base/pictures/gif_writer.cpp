#include <gif_lib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <numeric>

#include "core/base/pictures/picture_readers.h"

// Pictures that play, as GIF through giflib, in memory.
namespace homolog {

namespace {

constexpr std::size_t shades = 32, cells = shades * shades * shades;

/// The colour of a pixel, made a little lighter or darker by where it lies, so that a smooth surface shows no bands
/// [Bayer 1973]. The ground, which is the first pixel's, stays as it is.
std::array<std::uint8_t, 3> dithered(const Picture& picture, std::size_t x, std::size_t y) {
  static constexpr std::array<int, 16> order{0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};
  const std::uint8_t* pixel = picture.rgba.data() + 4 * (y * static_cast<std::size_t>(picture.width) + x);
  const bool is_ground = std::equal(pixel, pixel + 3, picture.rgba.begin());
  const int shift = is_ground ? 0 : order[4 * (y % 4) + x % 4] - 7;
  std::array<std::uint8_t, 3> colour{};
  for (std::size_t c = 0; c < 3; ++c) colour[c] = static_cast<std::uint8_t>(std::clamp(pixel[c] + shift, 0, 255));
  return colour;
}

std::size_t cell_of(const std::array<std::uint8_t, 3>& rgb) {
  return (rgb[0] / 8U * shades + rgb[1] / 8U) * shades + rgb[2] / 8U;
}

/// How often each colour is used, and its sums, so that a colour of the palette is the mean of what it stands for.
struct UsedColours {
  std::vector<std::uint32_t> counts = std::vector<std::uint32_t>(cells);
  std::vector<std::array<std::uint64_t, 3>> sums = std::vector<std::array<std::uint64_t, 3>>(cells);

  explicit UsedColours(const std::vector<Picture>& frames) {
    for (const Picture& frame : frames)
      for (std::size_t i = 0; i < frame.rgba.size() / 4; ++i) {
        if (frame.rgba[4 * i + 3] < 128) continue;
        const auto width = static_cast<std::size_t>(frame.width);
        const auto colour = dithered(frame, i % width, i / width);
        const std::size_t cell = cell_of(colour);
        ++counts[cell];
        for (std::size_t c = 0; c < 3; ++c) sums[cell][c] += colour[c];
      }
  }
};

std::size_t channel(std::size_t cell, std::size_t which) {
  return which == 0 ? cell / (shades * shades) : which == 1 ? cell / shades % shades : cell % shades;
}

/// The longest side of the box that colours fill, and how long it is.
std::pair<std::size_t, std::size_t> longest_side(const std::vector<std::size_t>& box) {
  std::pair<std::size_t, std::size_t> longest{0, 0};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto [low, high] = std::minmax_element(
        box.begin(), box.end(), [c](std::size_t a, std::size_t b) { return channel(a, c) < channel(b, c); });
    const std::size_t length = channel(*high, c) - channel(*low, c);
    if (length > longest.second) longest = {c, length};
  }
  return longest;
}

/// One palette for all frames, so that nothing flickers: the box of colours whose pixels lie farthest apart is
/// halved, until there are enough [after Heckbert 1982]. `colour_of`: which colour each cell gets.
std::vector<GifColorType> palette_of(const UsedColours& used, std::size_t most, std::vector<GifByteType>& colour_of) {
  std::vector<std::vector<std::size_t>> boxes(1);
  for (std::size_t cell = 0; cell < cells; ++cell)
    if (used.counts[cell] > 0) boxes[0].push_back(cell);
  if (boxes[0].empty()) boxes[0].push_back(0);
  while (boxes.size() < most) {
    std::vector<double> spreads;
    for (const auto& box : boxes) {
      double count = 0;
      for (const std::size_t cell : box) count += used.counts[cell];
      spreads.push_back(count * std::pow(longest_side(box).second, 2));
    }
    const auto widest = boxes.begin() + (std::max_element(spreads.begin(), spreads.end()) - spreads.begin());
    const auto [side, length] = longest_side(*widest);
    if (length == 0) break;
    std::stable_sort(widest->begin(), widest->end(),
                     [side = side](std::size_t a, std::size_t b) { return channel(a, side) < channel(b, side); });
    const auto middle = channel((*widest)[0], side) + (length + 1) / 2;
    const auto from = std::find_if(widest->begin(), widest->end(),
                                   [&, side = side](std::size_t cell) { return channel(cell, side) >= middle; });
    std::vector<std::size_t> rest(from, widest->end());
    widest->erase(from, widest->end());
    boxes.push_back(std::move(rest));
  }
  std::vector<GifColorType> palette;
  for (const auto& box : boxes) {
    std::array<std::uint64_t, 3> sum{};
    std::uint64_t count = 0;
    for (const std::size_t cell : box) {
      count += used.counts[cell];
      for (std::size_t c = 0; c < 3; ++c) sum[c] += used.sums[cell][c];
      colour_of[cell] = static_cast<GifByteType>(palette.size());
    }
    const auto mean = [&](std::size_t c) {
      return static_cast<GifByteType>(sum[c] / std::max<std::uint64_t>(1, count));
    };
    palette.push_back({mean(0), mean(1), mean(2)});
  }
  return palette;
}

int append(GifFileType* gif, const GifByteType* data, int size) {
  try {
    auto& bytes = *static_cast<std::vector<unsigned char>*>(gif->UserData);
    bytes.insert(bytes.end(), data, data + size);
    return size;
  } catch (const std::exception&) {
    return 0;
  }
}

bool put_loop(GifFileType* gif) {
  static constexpr std::array<unsigned char, 3> for_ever{1, 0, 0};
  return EGifPutExtensionLeader(gif, APPLICATION_EXT_FUNC_CODE) == GIF_OK &&
         EGifPutExtensionBlock(gif, 11, "NETSCAPE2.0") == GIF_OK &&
         EGifPutExtensionBlock(gif, 3, for_ever.data()) == GIF_OK && EGifPutExtensionTrailer(gif) == GIF_OK;
}

bool put_frame(GifFileType* gif, const Picture& frame, int hundredths, int clear,
               const std::vector<GifByteType>& colour_of) {
  const GraphicsControlBlock control{clear < 0 ? DISPOSE_DO_NOT : DISPOSE_BACKGROUND, false, hundredths, clear};
  std::array<GifByteType, 4> extension{};
  const auto size = EGifGCBToExtension(&control, extension.data());
  if (EGifPutExtension(gif, GRAPHICS_EXT_FUNC_CODE, static_cast<int>(size), extension.data()) != GIF_OK ||
      EGifPutImageDesc(gif, 0, 0, frame.width, frame.height, false, nullptr) != GIF_OK)
    return false;
  std::vector<GifByteType> row(static_cast<std::size_t>(frame.width));
  for (std::size_t y = 0; y < static_cast<std::size_t>(frame.height); ++y) {
    for (std::size_t x = 0; x < row.size(); ++x) {
      const std::uint8_t* pixel = frame.rgba.data() + 4 * (y * row.size() + x);
      row[x] =
          pixel[3] < 128 ? static_cast<GifByteType>(std::max(clear, 0)) : colour_of[cell_of(dithered(frame, x, y))];
    }
    if (EGifPutLine(gif, row.data(), frame.width) != GIF_OK) return false;
  }
  return true;
}

}  // namespace

Result<std::vector<unsigned char>> encode_gif(const std::vector<Picture>& frames, int hundredths,
                                              const std::filesystem::path& path) {
  std::vector<GifByteType> colour_of(cells);
  auto palette = palette_of(UsedColours(frames), 255, colour_of);
  bool any_clear = false;
  for (const Picture& frame : frames)
    for (std::size_t i = 3; !any_clear && i < frame.rgba.size(); i += 4) any_clear = frame.rgba[i] < 128;
  const int clear = any_clear ? static_cast<int>(palette.size()) : -1;
  palette.resize(256);
  std::vector<unsigned char> bytes;
  int error = 0;
  GifFileType* gif = EGifOpen(&bytes, append, &error);
  ColorMapObject* map = GifMakeMapObject(256, palette.data());
  bool written = gif != nullptr && map != nullptr;
  if (written) {
    EGifSetGifVersion(gif, true);
    written = EGifPutScreenDesc(gif, frames.front().width, frames.front().height, 8, 0, map) == GIF_OK && put_loop(gif);
    for (std::size_t k = 0; written && k < frames.size(); ++k)
      written = put_frame(gif, frames[k], hundredths, clear, colour_of);
  }
  GifFreeMapObject(map);
  if (gif != nullptr) written = (EGifCloseFile(gif, &error) == GIF_OK) && written;
  if (!written) return fail(path.string(), "cannot be written as GIF; make the picture smaller with --size");
  return bytes;
}

}  // namespace homolog
