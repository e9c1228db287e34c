#pragma once

#include <memory>
#include <string>

#include "python/homolog/binding.h"

namespace homolog::python {

// What the sources of homolog.Volume and homolog.LabelMap share.

using VolumeType = py::class_<HeldVolume, std::shared_ptr<HeldVolume>>;
using LabelMapType = py::class_<HeldLabels, HeldVolume, std::shared_ptr<HeldLabels>>;

/// p (LPS mm) = the upper left 3×3 · index + the last column.
struct Grid {
  Mat3 steps_mm = Mat3::Identity();
  Vec3 origin_mm = Vec3::Zero();
};

/// A grid as it is given: a 4×4 affine from voxel index to LPS mm, or spacing (mm), origin (LPS mm) and direction
/// (3×3). What is None has its usual value. Errors: both ways at once; shapes; numbers that make no grid.
Grid grid_from(const py::object& affine, const py::object& spacing_mm, const py::object& origin_mm,
               const py::object& direction);

/// A volume of an array (i, j, k) or (i, j, k, frame), copied. `names`: {value: name} of labels, or None. `labels`: it
/// is a label map. Errors: shape, dtype, values that are not finite, labels beyond 65535, axes not at right angles.
VolumeRead volume_from(const py::object& voxels, const Grid& grid, const py::object& names, double frame_seconds,
                       const std::string& modality, bool labels);

/// What Python's help says of the arguments that give voxels and grid.
inline constexpr const char* about_grid = R"(
voxels: whole numbers or floats, shape (i, j, k) or (i, j, k, frame), in any memory order; the first index runs along
    the grid's first axis, as in nibabel. They are copied once. float64 is kept as float32.
affine: 4×4, from voxel index to LPS mm. Or spacing_mm (3), origin_mm (3, centre of voxel (0, 0, 0), LPS) and direction
    (3×3, columns are the unit directions of i, j, k).
Errors: shape, dtype, values that are not finite or hidden by a mask, axes that are not at right angles.)";

// Each source adds its part.
void add_labels_of_map(LabelMapType& map);
void add_volume_files(py::module_& module, VolumeType& volume, LabelMapType& map);

}  // namespace homolog::python
