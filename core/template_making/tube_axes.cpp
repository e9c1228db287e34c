#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_quality.h"
#include "core/template_making/tube_body.h"

namespace homolog {
namespace {

/// The middles of a boundary's faces, each with its area in mm².
struct BoundaryFaces {
  Points middles;
  Eigen::VectorXd areas;
};

BoundaryFaces faces_of(const Mesh& boundary) {
  const auto& triangles = boundary.topology->triangles();
  BoundaryFaces faces{Points(triangles.rows(), 3), Eigen::VectorXd(triangles.rows())};
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    const auto corner = [&](Eigen::Index c) { return boundary.points.row(triangles(f, c)); };
    faces.middles.row(f) = (corner(0) + corner(1) + corner(2)) / 3;
    faces.areas[f] = 0.5 * area_normal(boundary, f).norm();
  }
  return faces;
}

/// The areas of a boundary within `depth_mm` of the plane that touches it in this direction.
Eigen::VectorXd areas_at_end(const BoundaryFaces& faces, const Vec3& direction, double depth_mm) {
  const Eigen::VectorXd heights = faces.middles * direction;
  return (heights.array() > heights.maxCoeff() - depth_mm).select(faces.areas, 0);
}

/// The outward normal of the largest flat end; none where no end is flat.
std::optional<Vec3> flat_end(const TubeBody& body, double depth_mm) {
  constexpr double flat_share = 0.5;  ///< share of the mean section across it
  const BoundaryFaces faces = faces_of(body.boundary);
  const Points directions = icosphere(3, 1).points;
  Vec3 best = Vec3::UnitZ();
  double most = -1;
  for (Eigen::Index d = 0; d < directions.rows(); ++d) {
    const Vec3 direction = directions.row(d).transpose();
    const double area = areas_at_end(faces, direction, depth_mm).sum();
    if (area <= most) continue;
    most = area;
    best = direction;
  }
  for (int round = 0; round < 4; ++round) {
    const Eigen::VectorXd areas = areas_at_end(faces, best, depth_mm);
    const Eigen::RowVector3d middle = (areas.transpose() * faces.middles) / areas.sum();
    const Points from = faces.middles.rowwise() - middle;
    const Mat3 spread = from.transpose() * areas.asDiagonal() * from;
    const Vec3 normal = Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvectors().col(0);
    best = normal.dot(best) < 0 ? Vec3(-normal) : normal;
  }
  const auto [first, last] = reach_along(body.region, best);
  const double section_mm2 = body.volume_mm3() / (last - first);
  if (areas_at_end(faces, best, depth_mm).sum() < flat_share * section_mm2) return std::nullopt;
  return best;
}

}  // namespace

std::vector<Vec3> likely_axes(const TubeBody& body) {
  const VolumeGeometry& grid = body.region.grid;
  Eigen::Index longest = 0;
  const double longest_mm = grid.spacing_mm.maxCoeff(&longest);
  std::vector<Vec3> axes;
  if (longest_mm >= thick_slices * grid.spacing_mm.minCoeff())
    axes.emplace_back(grid.direction.col(longest).normalized());
  else if (const auto normal = flat_end(body, 1.5 * longest_mm))
    axes.push_back(*normal);
  axes.push_back(body.main_axis);
  return axes;
}

Vec3 towards_smaller_end(const LabelBody& region, const Vec3& axis) {
  constexpr double end_share = 0.3;
  const auto [first, last] = reach_along(region, axis);
  const double part = end_share * (last - first);
  const double whole = volume_below(region, axis, last);
  const double behind = volume_below(region, axis, first + part);
  const double ahead = whole - volume_below(region, axis, last - part);
  return ahead <= behind ? axis : Vec3(-axis);
}

}  // namespace homolog
