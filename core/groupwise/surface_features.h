#pragma once

#include <vector>

#include "core/mesh/topology.h"
#include "core/model/alignment/procrustes.h"

namespace homolog {

/// The look of a surface around each of its vertices: n×6, the unit normal, then how far the vertex stands out of
/// the surface smoothed over three lengths (mm, positive on a bump). Unlike a position it stays with a place when
/// the organ grows or bends there.
using SurfaceFeatures = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>;

/// The features of every shape of an aligned set (3n×M, mm). The lengths are shares of `size_mm`, the square root of
/// the surfaces' mean area.
std::vector<SurfaceFeatures> surface_features(const std::shared_ptr<const Topology>& topology,
                                              const ShapeMatrix& aligned, double size_mm);

}  // namespace homolog
