#include "core/structures/maps/set_map.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "core/base/numbers/index.h"
#include "core/mesh/voxels/voxelise.h"
#include "core/volume/labels/label_boxes.h"

namespace homolog {

namespace {

/// The voxels of a grid whose centres lie within a mesh.
std::vector<std::size_t> voxels_within(const Mesh& mesh, const VolumeGeometry& grid) {
  const VoxelBox box = voxels_around(bounds_of(mesh.points), grid, 1);
  const auto inside = voxelise(mesh, part_of_grid(grid, box));
  std::vector<std::size_t> voxels;
  std::size_t at = 0;
  for (int k = box.first[2]; k <= box.last[2]; ++k)
    for (int j = box.first[1]; j <= box.last[1]; ++j)
      for (int i = box.first[0]; i <= box.last[0]; ++i, ++at)
        if (inside[at] != 0) voxels.push_back(grid.index(i, j, k));
  return voxels;
}

/// Gives voxels a value where neither they nor those of `others` have one; how many have one.
template <class Voxels>
std::size_t fill(Voxels& voxels, const std::vector<std::size_t>& which, int value,
                 const std::vector<std::pair<const Volume*, int>>& others) {
  std::size_t taken = 0;
  for (const std::size_t v : which) {
    const bool is_held = voxels[v] != 0 || std::ranges::any_of(others, [&](const auto& other) {
                           return rounded_label(std::get<Voxels>(other.first->data)[v]) == other.second;
                         });
    if (is_held)
      ++taken;
    else
      voxels[v] = static_cast<typename Voxels::value_type>(value);
  }
  return taken;
}

Volume empty_layer(const VolumeGeometry& grid, int largest) {
  Volume layer;
  layer.geometry = grid;
  layer.range_max = largest;
  if (largest < 256)
    layer.data = std::vector<std::uint8_t>(grid.voxels(), 0);
  else
    layer.data = std::vector<std::uint16_t>(grid.voxels(), 0);
  return layer;
}

/// A layer that is being filled, and the values in it.
struct FilledLayer {
  Volume volume;
  std::set<int> values;

  std::size_t held(const std::vector<std::size_t>& voxels) const {
    return std::visit(
        [&](const auto& labels) {
          return static_cast<std::size_t>(std::ranges::count_if(voxels, [&](std::size_t v) { return labels[v] != 0; }));
        },
        volume.data);
  }
  void put(const std::vector<std::size_t>& voxels, int value) {
    values.insert(value);
    std::visit(
        [&]<class T>(std::vector<T>& labels) {
          for (const std::size_t v : voxels) labels[v] = static_cast<T>(value);
        },
        volume.data);
  }
};

/// The layers of the segments, to those written, in their order; and the largest value.
std::pair<std::map<std::size_t, std::size_t>, int> layers_and_largest(const std::vector<MeshOfSegment>& meshes) {
  std::map<std::size_t, std::size_t> layers;
  int largest = 1;
  for (const MeshOfSegment& one : meshes) {
    layers.emplace(one.segment.layer, 0);
    largest = std::max(largest, one.segment.value);
  }
  std::size_t count = 0;
  for (auto& [from, to] : layers) to = count++;
  return {std::move(layers), largest};
}

}  // namespace

MapOfMeshes map_of_meshes(const std::vector<MeshOfSegment>& meshes, const VolumeGeometry& grid,
                          std::span<const MeshPair> apart) {
  auto [layers, largest] = layers_and_largest(meshes);
  std::vector<Volume> volumes(std::max<std::size_t>(1, layers.size()), empty_layer(grid, largest));
  MapOfMeshes made;
  VolumeRead& map = made.map;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    Segment segment = meshes[m].segment;
    segment.layer = layers[segment.layer];
    std::vector<std::pair<const Volume*, int>> others;  // in other layers, that are filled already
    for (const auto& [a, b] : apart) {
      if (std::max(a, b) != m) continue;
      const Segment& other = meshes[std::min(a, b)].segment;
      if (layers[other.layer] != segment.layer) others.emplace_back(&volumes[layers[other.layer]], other.value);
    }
    made.contested_voxels += std::visit(
        [&](auto& voxels) { return fill(voxels, voxels_within(meshes[m].mesh, grid), segment.value, others); },
        volumes[segment.layer].data);
    map.segmentation.add(std::move(segment));
  }
  map.volume = std::move(volumes.front());
  volumes.erase(volumes.begin());
  map.other_layers = std::move(volumes);
  return made;
}

MapOfMeshes map_in_layers(const std::vector<MeshOfSegment>& meshes, const VolumeGeometry& grid) {
  auto [layers, largest] = layers_and_largest(meshes);
  const Volume empty = empty_layer(grid, largest);
  std::vector<FilledLayer> filled(std::max<std::size_t>(1, layers.size()), FilledLayer{empty, {}});
  MapOfMeshes made;
  for (const MeshOfSegment& one : meshes) {
    const auto voxels = voxels_within(one.mesh, grid);
    Segment segment = one.segment;
    segment.layer = layers[segment.layer];
    const std::size_t contested = filled[segment.layer].held(voxels);
    made.contested_voxels += contested;
    if (contested > 0) {
      const auto free = std::ranges::find_if(filled, [&](const FilledLayer& layer) {
        return !layer.values.contains(segment.value) && layer.held(voxels) == 0;
      });
      segment.layer = static_cast<std::size_t>(free - filled.begin());
      if (free == filled.end()) filled.push_back({empty, {}});
    }
    filled[segment.layer].put(voxels, segment.value);
    made.map.segmentation.add(std::move(segment));
  }
  made.map.volume = std::move(filled.front().volume);
  for (std::size_t l = 1; l < filled.size(); ++l) made.map.other_layers.push_back(std::move(filled[l].volume));
  return made;
}

}  // namespace homolog
