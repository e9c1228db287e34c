#pragma once

#include <memory>
#include <string>

#include "python/homolog/binding.h"

namespace homolog::python {

// Volumes of numpy arrays.

/// p (LPS mm) = the upper left 3×3 · index + the last column.
struct Grid {
  Mat3 steps_mm = Mat3::Identity();
  Vec3 origin_mm = Vec3::Zero();
};

/// Of an affine matrix, or of the other three. Errors: both, or none that is a grid.
Grid grid_from(const py::object& affine, const py::object& spacing_mm, const py::object& origin_mm,
               const py::object& direction);

/// A volume of an array [i, j, k] or [i, j, k, frame]. `names`: None, or a dict of labels. Errors: voxels that are no
/// image or, with `labels`, no label map.
std::shared_ptr<const VolumeRead> volume_from(const py::object& voxels, const Grid& grid, const py::object& names,
                                              double frame_seconds, const std::string& modality, bool labels);

}  // namespace homolog::python
