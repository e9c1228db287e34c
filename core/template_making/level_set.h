#pragma once

#include <vector>

#include "core/mesh/topology.h"
#include "core/template_making/voxel_components.h"
#include "core/volume/volume.h"

namespace homolog {

/// A closed surface as the zero level of values on an isotropic grid: negative inside, near the surface about the
/// signed distance in mm.
class LevelSet {
 public:
  LevelSet() = default;
  /// `values`: one a voxel of `grid`, i fastest. The outermost voxels must be positive.
  LevelSet(const VolumeGeometry& grid, std::vector<float> values);

  const VolumeGeometry& grid() const { return grid_; }
  const std::vector<float>& values() const { return values_; }
  double spacing_mm() const { return grid_.spacing_mm[0]; }

  struct Sample {
    double value;   ///< trilinear, mm; beyond the grid that of its rim
    Vec3 gradient;  ///< per mm
  };
  Sample sample(const Vec3& p_mm) const;
  /// The point of the surface that is reached from `p_mm`, which must lie near it, down the gradient.
  Vec3 onto_surface(Vec3 p_mm) const;

 private:
  VolumeGeometry grid_;
  std::vector<float> values_;
  Mat3 to_voxel_ = Mat3::Identity();
};

/// The signed distance to the boundary between the voxels where `inside` is not 0 and the others. `grid` must leave a
/// rim of voxels outside; its spacing need not be isotropic.
LevelSet signed_distance(const std::vector<std::uint8_t>& inside, const VolumeGeometry& grid);
/// On voxels of `spacing_mm` in the same axes. Without stairs where slices are thick, if values are distances
/// [Raya and Udupa 1990, Shape-Based Interpolation].
LevelSet resampled(const LevelSet& surface, double spacing_mm);

/// Fills what no ball of `radius_mm` that lies outside covers; a pocket that holds such a ball stays, also behind a
/// narrow neck. Elsewhere values stay as they are.
LevelSet closed_by(const LevelSet& surface, double radius_mm);
/// Removes what a ball of `radius_mm` does not fit into. Elsewhere values stay as they are.
LevelSet opened_by(const LevelSet& surface, double radius_mm);
/// Smoothed by a Gaussian of standard deviation `sigma_mm`, values first limited to ±4 sigma; or one for each axis of
/// the grid, values limited by the largest.
LevelSet smoothed(const LevelSet& surface, double sigma_mm);
LevelSet smoothed(const LevelSet& surface, const Vec3& sigma_mm);

/// The surface where it is smoothed by `sigma_mm` near `places` (LPS mm), fading over about `radius_mm`.
LevelSet smoothed_near(const LevelSet& surface, double sigma_mm, const std::vector<Vec3>& places, double radius_mm);

/// Keeps the largest body only and fills its cavities; says what became of the rest.
OneBody make_one_body(LevelSet& surface);

/// 1 for every voxel with a negative value.
std::vector<std::uint8_t> inside_of(const LevelSet& surface);
/// The zero level as a mesh, LPS mm, outward oriented; its topology is that of the voxels inside (6-connected).
Result<Mesh> surface_of(const LevelSet& surface);

}  // namespace homolog
