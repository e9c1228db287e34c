#include "core/volume/check_volume.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <variant>

namespace homolog {

Result<void> check_volume(const Volume& volume) {
  const VolumeGeometry& grid = volume.geometry;
  const auto values = std::visit([](const auto& voxels) { return voxels.size(); }, volume.data);
  if (std::ranges::any_of(grid.dims, [](int voxels) { return voxels < 1; }) || volume.frames < 1 || values == 0)
    return fail("", "holds no voxels; read or make it again");
  if (values != grid.voxels() * static_cast<std::size_t>(volume.frames))
    return fail("", "holds " + std::to_string(values) + " values, which is not what its grid says; read it again");
  const double turned = grid.direction.determinant();
  if (!(grid.spacing_mm.array() > 0).all() || !grid.spacing_mm.allFinite() || !grid.origin_mm.allFinite() ||
      !std::isfinite(turned) || turned == 0)
    return fail("", "lies nowhere: its spacing, origin or axes are no numbers that a grid can have; correct them");
  return {};
}

Result<void> check_frame_of(const Volume& volume, int frame) {
  if (frame < 0 || frame >= volume.frames)
    return fail(
        "", "has no frame " + std::to_string(frame) + "; it has " + std::to_string(volume.frames) + ", counted from 0");
  return check_volume(volume);
}

}  // namespace homolog
