#include "core/deform/local_rotations.h"

#include "core/base/numbers/rotation.h"
#include "core/base/processes/parallel.h"

namespace homolog {

namespace {

/// Newton's method for the rotation R with the largest tr(Rᵀ a) [Kugelstadt, Koschier and Bender 2018]; several times
/// cheaper than an SVD. False where it cannot tell that it came to the largest.
bool climb_to_rotation(const Mat3& a, Eigen::Quaterniond& q) {
  for (int iteration = 0; iteration < 10; ++iteration) {
    const Mat3 b = q.toRotationMatrix().transpose() * a;
    const Vec3 slope(b(2, 1) - b(1, 2), b(0, 2) - b(2, 0), b(1, 0) - b(0, 1));
    const Mat3 bend = b.trace() * Mat3::Identity() - 0.5 * (b + b.transpose());
    const double least = 1e-9 * std::abs(bend.trace());
    const double minor = bend(0, 0) * bend(1, 1) - bend(0, 1) * bend(1, 0);
    const bool on_the_hill = bend(0, 0) > least && minor > least * bend(0, 0) && bend.determinant() > least * minor;
    if (!on_the_hill) return false;
    const Vec3 turn = bend.inverse() * slope;
    q = (q * Eigen::Quaterniond(1, 0.5 * turn.x(), 0.5 * turn.y(), 0.5 * turn.z())).normalized();
    if (turn.squaredNorm() < 1e-14) return true;  // the error is of the square of the last turn
  }
  return false;
}

}  // namespace

std::vector<Mat3> local_rotations(const Topology& topology, const Points& reference, const Points& points) {
  std::vector<Mat3> rotations(static_cast<std::size_t>(topology.vertices()));
  in_parallel(topology.vertices(), [&](Eigen::Index first, Eigen::Index last) {
    for (Eigen::Index i = first; i < last; ++i) {
      Mat3 covariance = Mat3::Zero();
      for (const std::int32_t j : topology.one_ring(i)) {
        covariance.noalias() +=
            (points.row(i) - points.row(j)).transpose() * (reference.row(i) - reference.row(j)).eval();
      }
      Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
      rotations[i] = climb_to_rotation(covariance, q) ? q.toRotationMatrix() : nearest_rotation(covariance);
    }
  });
  return rotations;
}

Points rotated_reference_force(const Topology& topology, const VertexScalars& w, const Points& reference,
                               const std::vector<Mat3>& rotations) {
  Points b = Points::Zero(topology.vertices(), 3);
  for (const auto& [i, j] : topology.edges()) {
    const Vec3 edge = (reference.row(i) - reference.row(j)).transpose();
    const Vec3 force = w[i] * (rotations[i] * edge) + w[j] * (rotations[j] * edge);
    b.row(i) += force.transpose();
    b.row(j) -= force.transpose();
  }
  return b;
}

double strain_share(const Topology& topology, const Points& reference, const Points& points) {
  const std::vector<Mat3> rotations = local_rotations(topology, reference, points);
  double strain = 0, edges = 0;
  for (Eigen::Index i = 0; i < topology.vertices(); ++i)
    for (const std::int32_t j : topology.one_ring(i)) {
      const Vec3 edge = (reference.row(i) - reference.row(j)).transpose();
      const Vec3 now = (points.row(i) - points.row(j)).transpose();
      strain += (now - rotations[i] * edge).squaredNorm();
      edges += edge.squaredNorm();
    }
  return strain / edges;
}

}  // namespace homolog
