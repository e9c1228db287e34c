#pragma once

#include <Eigen/Core>
#include <limits>

#include "core/mesh/topology.h"
#include "core/volume/volume.h"

namespace homolog {

/// A sample beyond the scan: NaN.
inline constexpr float not_shown = std::numeric_limits<float>::quiet_NaN();

/// Intensities along the normal of every vertex, outward: column i belongs to vertex i, row k lies at
/// (k − middle) · step_mm from it. `not_shown` beyond the scan.
struct Profiles {
  Eigen::MatrixXf values;
  double step_mm = 1;
  Points normals;  ///< unit, of the vertices

  Eigen::Index middle() const { return values.rows() / 2; }
  double at_mm(Eigen::Index k) const { return static_cast<double>(k - middle()) * step_mm; }
};

/// The distance between samples that loses nothing: half of the image's middle voxel size.
double profile_step_mm(const Volume& image);

/// Trilinear samples of a frame up to `reach_mm` to both sides.
Profiles sample_profiles(const Volume& image, int frame, const Mesh& mesh, double reach_mm, double step_mm);

/// Each column averaged with those of its one-ring, what is not shown left out: noise goes down and an edge along the
/// mesh stays.
Profiles smoothed_over_surface(const Topology& topology, Profiles profiles);

}  // namespace homolog
