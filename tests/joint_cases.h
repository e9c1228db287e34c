#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "core/mesh/construction/icosphere.h"
#include "core/model/joint_models/structure_parts.h"

namespace homolog {

/// A pair of ellipsoids one above the other, as a case of two structures. The upper one has a known pose.
struct JointCase {
  double turn_deg = 0, offset_mm = 0, scale = 1;  ///< the upper one's: about its middle and along z
  double length = 1;                              ///< the length of both along x: their shape
};

constexpr double joint_gap_mm = 60;

inline Mesh lower_ellipsoid(const JointCase& one) {
  Mesh mesh = icosphere(2, 20);
  mesh.points.col(0) *= 1.5 * one.length;
  mesh.points.col(2) *= 0.6;
  return mesh;
}

inline Mesh upper_ellipsoid(const JointCase& one) {
  Mesh mesh = lower_ellipsoid(one);
  const double turn = one.turn_deg * std::numbers::pi / 180;
  const Eigen::Matrix3d turned = Eigen::AngleAxisd(turn, Vec3::UnitZ()).toRotationMatrix();
  mesh.points = (one.scale * mesh.points * turned.transpose()).eval();
  mesh.points.col(2).array() += joint_gap_mm + one.offset_mm;
  return mesh;
}

/// The lower ones' vertices, then the upper ones'.
inline ShapeMatrix joint_shapes(const std::vector<JointCase>& cases) {
  ShapeMatrix shapes(2 * 3 * icosphere(2, 1).points.rows(), std::ssize(cases));
  for (Eigen::Index s = 0; s < shapes.cols(); ++s) {
    const Points low = lower_ellipsoid(cases[static_cast<std::size_t>(s)]).points;
    const Points high = upper_ellipsoid(cases[static_cast<std::size_t>(s)]).points;
    shapes.col(s) << Eigen::Map<const Eigen::VectorXd>(low.data(), low.size()),
        Eigen::Map<const Eigen::VectorXd>(high.data(), high.size());
  }
  return shapes;
}

inline std::vector<StructurePart> joint_parts() {
  const Mesh ball = icosphere(2, 1);
  const Eigen::Index n = ball.points.rows(), t = ball.topology->triangles().rows();
  return {{"low", 0, n, 0, t}, {"high", n, n, t, t}};
}

}  // namespace homolog
