#include "core/adapt/match/smooth_displacement.h"

#include <cmath>

namespace homolog {

namespace {

Eigen::MatrixXd squared_distances(const Points& a, const Points& b) {
  const Eigen::VectorXd a2 = a.rowwise().squaredNorm(), b2 = b.rowwise().squaredNorm();
  Eigen::MatrixXd distances = -2 * a * b.transpose();
  distances.colwise() += a2;
  distances.rowwise() += b2.transpose();
  return distances;
}

Eigen::MatrixXd bump(const Eigen::MatrixXd& distances_mm2, double size_mm, double reach_mm) {
  return size_mm * size_mm * (distances_mm2.array() / (-2 * reach_mm * reach_mm)).exp();
}

}  // namespace

SmoothDisplacement::SmoothDisplacement(const Points& nodes, const Eigen::RowVector3d& centre,
                                       const DisplacementScales& scales)
    : centre_(centre), nodes_(nodes.rowwise() - centre), scales_(scales) {
  Eigen::MatrixXd among = covariance(nodes);
  among.diagonal().array() += 1e-6 * among.diagonal().maxCoeff();
  root_.compute(among);
}

Eigen::MatrixXd SmoothDisplacement::covariance(const Points& places, Eigen::MatrixXd* steepness) const {
  const auto [bend_mm, bend_reach_mm, fine_mm, fine_reach_mm, stretch] = scales_;
  const Points from_centre = places.rowwise() - centre_;
  const Eigen::MatrixXd apart_mm2 = squared_distances(from_centre, nodes_),
                        fine = bump(apart_mm2, fine_mm, fine_reach_mm);
  Eigen::MatrixXd sum = bump(apart_mm2, bend_mm, bend_reach_mm);
  if (steepness != nullptr) *steepness = sum / (bend_reach_mm * bend_reach_mm) + fine / (fine_reach_mm * fine_reach_mm);
  sum += fine;
  sum.noalias() += stretch * stretch * from_centre * nodes_.transpose();
  sum.array() += bend_mm * bend_mm;  // a shift of the whole
  return sum;
}

SmoothDisplacement::Basis SmoothDisplacement::basis(const Points& places) const {
  Basis basis{places, {}, {}};
  const Eigen::MatrixXd with_nodes = covariance(places, &basis.steepness);
  basis.value = root_.matrixL().solve(with_nodes.transpose()).transpose();
  return basis;
}

Points SmoothDisplacement::at(const Points& places, const Coefficients& by) const {
  return covariance(places) * bumps(by);
}

/// They turn by the inverse transpose of the displacement's derivative, which its cofactors are but for their size.
Points SmoothDisplacement::turned_normals(const Basis& basis, const Points& normals, const Coefficients& by) const {
  const Coefficients bumps_of = bumps(by);
  Eigen::Matrix<double, Eigen::Dynamic, 12> towards(nodes(), 12);
  towards.leftCols<3>() = bumps_of;
  for (int d = 0; d < 3; ++d) towards.middleCols<3>(3 + 3 * d) = nodes_.col(d).asDiagonal() * bumps_of;
  const Eigen::Matrix<double, Eigen::Dynamic, 12> sums = basis.steepness * towards;
  const Mat3 everywhere = Mat3::Identity() + scales_.stretch * scales_.stretch * nodes_.transpose() * bumps_of;
  Points turned = normals;
  for (Eigen::Index i = 0; i < normals.rows(); ++i) {
    const Eigen::RowVector3d place = basis.places.row(i) - centre_;
    const auto slope = [&](int d) -> Vec3 {
      return everywhere.row(d) + sums.row(i).segment<3>(3 + 3 * d) - place[d] * sums.row(i).head<3>();
    };
    const Vec3 x = slope(0), y = slope(1), z = slope(2);
    const auto& before = normals.row(i);
    const Vec3 normal = before.x() * y.cross(z) + before.y() * z.cross(x) + before.z() * x.cross(y);
    const double length = normal.norm();
    if (length > 0) turned.row(i) = normal.transpose() / length;
  }
  return turned;
}

}  // namespace homolog
