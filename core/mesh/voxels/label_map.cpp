#include "core/mesh/voxels/label_map.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "core/mesh/voxels/voxelise.h"

namespace homolog {

Volume label_map(const Mesh& mesh, const VolumeGeometry& grid, int value) {
  assert(value > 0 && value <= std::numeric_limits<std::int16_t>::max());
  Volume labels;
  labels.geometry = grid;
  std::vector<std::uint8_t> inside = voxelise(mesh, grid);
  const bool any = std::find(inside.begin(), inside.end(), 1) != inside.end();
  labels.range_max = any ? value : 0;
  if (value <= std::numeric_limits<std::uint8_t>::max()) {
    for (std::uint8_t& voxel : inside) voxel = static_cast<std::uint8_t>(voxel * value);
    labels.data = std::move(inside);
  } else {
    std::vector<std::int16_t> wide(inside.begin(), inside.end());
    for (std::int16_t& voxel : wide) voxel = static_cast<std::int16_t>(voxel * value);
    labels.data = std::move(wide);
  }
  return labels;
}

}  // namespace homolog
