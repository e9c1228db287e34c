#include "core/deform/local_rotations.h"

#include "core/base/rotation.h"

namespace homolog {

namespace {

/// Müller, Bender, Chentanez and Macklin 2016, "A robust method to extract the rotational part of deformations": a
/// fixed-point iteration that is several times cheaper than an SVD and never yields a reflection. False where it has
/// not settled.
bool extract_rotation(const Mat3& a, Eigen::Quaterniond& q) {
  for (int iteration = 0; iteration < 40; ++iteration) {
    const Mat3 r = q.toRotationMatrix();
    const Vec3 moment = r.col(0).cross(a.col(0)) + r.col(1).cross(a.col(1)) + r.col(2).cross(a.col(2));
    const double stretch = std::abs((r.array() * a.array()).sum());
    const Vec3 turn = moment / (stretch + 1e-300);
    const double angle = turn.norm();
    if (angle < 1e-8) return stretch > 0;
    q = (Eigen::AngleAxisd(angle, turn / angle) * q).normalized();
  }
  return false;
}

}  // namespace

std::vector<Mat3> fit_local_rotations(const Topology& topology, const Points& reference, const Points& points) {
  std::vector<Mat3> rotations(static_cast<std::size_t>(topology.vertices()));
  for (Eigen::Index i = 0; i < topology.vertices(); ++i) {
    Mat3 covariance = Mat3::Zero();
    for (const std::int32_t j : topology.one_ring(i)) {
      covariance.noalias() +=
          (points.row(i) - points.row(j)).transpose() * (reference.row(i) - reference.row(j)).eval();
    }
    Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
    rotations[static_cast<std::size_t>(i)] =
        extract_rotation(covariance, q) ? q.toRotationMatrix() : nearest_rotation(covariance);
  }
  return rotations;
}

Points rotated_reference_force(const Topology& topology, const VertexScalars& w, const Points& reference,
                               const std::vector<Mat3>& rotations) {
  Points b = Points::Zero(topology.vertices(), 3);
  for (const auto& [i, j] : topology.edges()) {
    const Vec3 edge = (reference.row(i) - reference.row(j)).transpose();
    const Vec3 force =
        w[i] * (rotations[static_cast<std::size_t>(i)] * edge) + w[j] * (rotations[static_cast<std::size_t>(j)] * edge);
    b.row(i) += force.transpose();
    b.row(j) -= force.transpose();
  }
  return b;
}

}  // namespace homolog
