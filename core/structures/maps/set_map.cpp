#include "core/structures/maps/set_map.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/base/numbers/index.h"
#include "core/mesh/voxels/voxelise.h"
#include "core/volume/labels/label_boxes.h"

namespace homolog {

namespace {

/// Gives the voxels within a mesh its value where neither they nor those of `others` have one; how many have one.
template <class Voxels>
std::size_t fill(Voxels& voxels, const Mesh& mesh, const VolumeGeometry& grid, int value,
                 const std::vector<std::pair<const Volume*, int>>& others) {
  const VoxelBox box = voxels_around(bounds_of(mesh.points), grid, 1);
  const VolumeGeometry part = part_of_grid(grid, box);
  const auto inside = voxelise(mesh, part);
  const auto is_held = [&](std::size_t voxel) {
    return voxels[voxel] != 0 || std::ranges::any_of(others, [&](const auto& other) {
             return rounded_label(std::get<Voxels>(other.first->data)[voxel]) == other.second;
           });
  };
  std::size_t at = 0, taken = 0;
  for (int k = box.first[2]; k <= box.last[2]; ++k)
    for (int j = box.first[1]; j <= box.last[1]; ++j) {
      const std::size_t row = grid.index(0, j, k);
      for (int i = box.first[0]; i <= box.last[0]; ++i, ++at) {
        if (inside[at] == 0) continue;
        if (is_held(row + index(i)))
          ++taken;
        else
          voxels[row + index(i)] = static_cast<typename Voxels::value_type>(value);
      }
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

}  // namespace

MapOfMeshes map_of_meshes(const std::vector<MeshOfSegment>& meshes, const VolumeGeometry& grid,
                          std::span<const MeshPair> apart) {
  std::map<std::size_t, std::size_t> layers;  // of the segments, to those written
  int largest = 1;
  for (const MeshOfSegment& one : meshes) {
    layers.emplace(one.segment.layer, 0);
    largest = std::max(largest, one.segment.value);
  }
  std::size_t count = 0;
  for (auto& [from, to] : layers) to = count++;
  std::vector<Volume> volumes(std::max<std::size_t>(1, count), empty_layer(grid, largest));
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
    made.contested_voxels +=
        std::visit([&](auto& voxels) { return fill(voxels, meshes[m].mesh, grid, segment.value, others); },
                   volumes[segment.layer].data);
    map.segmentation.add(std::move(segment));
  }
  map.volume = std::move(volumes.front());
  volumes.erase(volumes.begin());
  map.other_layers = std::move(volumes);
  return made;
}

}  // namespace homolog
