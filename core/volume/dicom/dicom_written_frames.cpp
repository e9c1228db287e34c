#include "core/volume/dicom/dicom_written_frames.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/volume/labels/soft_mask.h"

namespace homolog {

namespace {

/// Calls `see(voxel, value)` for every voxel of the grid with its value in a layer; 0 where the layer has none.
template <class See>
void for_each_voxel(const Volume& layer, const VolumeGeometry& grid, const VoxelMapping& mapping, const See& see) {
  std::size_t voxel = 0;
  for (std::int64_t k = 0; k < grid.dims[2]; ++k)
    for (std::int64_t j = 0; j < grid.dims[1]; ++j)
      for (std::int64_t i = 0; i < grid.dims[0]; ++i) {
        const auto at = mapping.at(i, j, k);
        bool inside = true;
        for (std::size_t b = 0; b < 3; ++b) inside = inside && at[b] >= 0 && at[b] < layer.geometry.dims[b];
        const auto index = [&](std::size_t b) { return static_cast<int>(at[b]); };
        see(voxel++, inside ? layer.at(index(0), index(1), index(2)) : 0.0);
      }
}

/// A layer of the map on the grid of the series, and the labels that occur on each of its slices.
struct SeriesLayer {
  std::vector<int> labels;
  std::vector<std::set<int>> on_slice;
};

SeriesLayer on_series(const Volume& layer, const VolumeGeometry& grid, const VoxelMapping& mapping) {
  SeriesLayer result;
  const std::size_t pixels = static_cast<std::size_t>(grid.dims[0]) * static_cast<std::size_t>(grid.dims[1]);
  result.labels.reserve(grid.voxels());
  result.on_slice.resize(static_cast<std::size_t>(grid.dims[2]));
  int last = 0;
  for_each_voxel(layer, grid, mapping, [&](std::size_t voxel, double value) {
    const int label = rounded_label(value);
    if (label != 0 && (label != last || voxel % pixels == 0)) result.on_slice[voxel / pixels].insert(label);
    result.labels.push_back(last = label);
  });
  return result;
}

std::vector<WrittenSegment> segments_of_labels(const VolumeRead& map) {
  std::vector<WrittenSegment> written;
  const auto add_layer = [&](const Volume& layer, std::size_t index) {
    for (const auto& [value, voxels] : labels_of(layer)) {
      const Segment* known =
          map.other_layers.empty() ? map.segmentation.find(value) : map.segmentation.find(value, index);
      Segment segment = known != nullptr ? *known : Segment{.name = {}, .value = value};
      segment.layer = index;
      written.push_back({std::move(segment), 0});
    }
  };
  add_layer(map.volume, 0);
  for (std::size_t l = 0; l < map.other_layers.size(); ++l) add_layer(map.other_layers[l], l + 1);
  std::stable_sort(written.begin(), written.end(),
                   [](const WrittenSegment& a, const WrittenSegment& b) { return a.segment.value < b.segment.value; });
  for (std::size_t s = 0; s < written.size(); ++s) written[s].number = static_cast<int>(s) + 1;
  return written;
}

/// Each layer as a segment.
Result<std::vector<WrittenSegment>> segments_of_shares(const VolumeRead& map) {
  std::vector<WrittenSegment> written;
  const auto layers = map.layers();
  for (std::size_t l = 0; l < layers.size(); ++l) {
    if (!is_soft(*layers[l], 0)) {
      const auto labels = labels_of(*layers[l]);
      if (labels.empty()) continue;
      if (labels.size() > 1 || !labels.contains(1))
        return fail("",
                    "holds soft masks and a layer of labels, which one DICOM segmentation cannot hold; write them "
                    "one by one");
    }
    const Segment* known = layers.size() == 1 ? map.segmentation.find(1) : map.segmentation.find(1, l);
    Segment segment = known != nullptr ? *known : Segment{.name = {}, .value = 1};
    segment.layer = l;
    written.push_back({std::move(segment), static_cast<int>(written.size()) + 1});
  }
  return written;
}

WrittenFrames binary_frames(const VolumeRead& map, const std::vector<WrittenSegment>& segments,
                            const VolumeGeometry& grid, const VoxelMapping& mapping, Progress* progress) {
  WrittenFrames frames;
  std::vector<SeriesLayer> layers{on_series(map.volume, grid, mapping)};
  for (const Volume& layer : map.other_layers) layers.push_back(on_series(layer, grid, mapping));
  const std::size_t pixels = static_cast<std::size_t>(grid.dims[0]) * static_cast<std::size_t>(grid.dims[1]);
  std::size_t bit = 0;
  for (const WrittenSegment& one : segments) {
    if (progress && progress->cancelled()) return frames;
    const SeriesLayer& layer = layers[one.segment.layer];
    for (std::size_t k = 0; k < layer.on_slice.size(); ++k) {
      if (!layer.on_slice[k].contains(one.segment.value)) continue;
      frames.pixels.resize((bit + pixels + 7) / 8);
      for (std::size_t p = 0; p < pixels; ++p) {
        if (layer.labels[k * pixels + p] != one.segment.value) continue;
        char& byte = frames.pixels[(bit + p) / 8];
        byte = static_cast<char>(static_cast<unsigned char>(byte) | 1U << (bit + p) % 8);
        frames.hash.add(p);
      }
      bit += pixels;
      frames.of.emplace_back(one.number, static_cast<int>(k));
      frames.hash.add(static_cast<std::uint64_t>(one.number) << 32 | k);
    }
  }
  return frames;
}

/// The least value that can stand for 1 so that all shares are whole; 255 where there is none.
int full_of(const std::vector<const Volume*>& layers) {
  constexpr int most = 255;
  constexpr double whole = 1e-4;
  for (int full = 2; full < most; ++full) {
    const auto fits = [&](double share) { return std::abs(full * share - std::rint(full * share)) <= whole; };
    if (std::ranges::all_of(layers, [&](const Volume* layer) {
          return std::visit([&](const auto& all) { return std::ranges::all_of(all, fits); }, layer->data);
        }))
      return full;
  }
  return most;
}

WrittenFrames soft_frames(const VolumeRead& map, const std::vector<WrittenSegment>& segments,
                          const VolumeGeometry& grid, const VoxelMapping& mapping, Progress* progress) {
  WrittenFrames frames;
  const auto layers = map.layers();
  frames.full = full_of(layers);
  frames.hash.add(static_cast<std::uint64_t>(frames.full));
  const std::size_t pixels = static_cast<std::size_t>(grid.dims[0]) * static_cast<std::size_t>(grid.dims[1]);
  for (const WrittenSegment& one : segments) {
    if (progress && progress->cancelled()) return frames;
    std::string frame(pixels, '\0');
    bool any = false;
    for_each_voxel(*layers[one.segment.layer], grid, mapping, [&](std::size_t voxel, double share) {
      const long stored = std::lround(frames.full * std::clamp(share, 0.0, 1.0));
      frames.rounded = std::max(frames.rounded, std::abs(static_cast<double>(stored) / frames.full - share));
      frame[voxel % pixels] = static_cast<char>(stored);
      any = any || stored != 0;
      if (voxel % pixels != pixels - 1) return;
      if (any) {
        const auto slice = static_cast<int>(voxel / pixels);
        for (const char c : frame) frames.hash.add(static_cast<unsigned char>(c));
        frames.hash.add(static_cast<std::uint64_t>(one.number) << 32 | static_cast<std::uint64_t>(slice));
        frames.of.emplace_back(one.number, slice);
        frames.pixels += frame;
      }
      any = false;
    });
  }
  return frames;
}

}  // namespace

bool is_fractional(const VolumeRead& map) {
  const auto layers = map.layers();
  return std::ranges::any_of(layers, [](const Volume* layer) { return is_soft(*layer, 0); });
}

Result<std::vector<WrittenSegment>> segments_to_write(const VolumeRead& map) {
  if (is_fractional(map)) return segments_of_shares(map);
  return segments_of_labels(map);
}

WrittenFrames frames_to_write(const VolumeRead& map, const std::vector<WrittenSegment>& segments,
                              const VolumeGeometry& grid, const VoxelMapping& mapping, Progress* progress) {
  return is_fractional(map) ? soft_frames(map, segments, grid, mapping, progress)
                            : binary_frames(map, segments, grid, mapping, progress);
}

}  // namespace homolog
