#include "core/adapt/match/smooth_displacement.h"

namespace homolog {

SmoothDisplacement::SmoothDisplacement(const Points& nodes, const Eigen::RowVector3d& centre,
                                       const DisplacementScales& scales)
    : centre_(centre), nodes_(nodes.rowwise() - centre), scales_(scales) {
  Eigen::MatrixXd among = covariance(nodes);
  among.diagonal().array() += 1e-6 * among.diagonal().maxCoeff();
  root_.compute(among);
}

Eigen::MatrixXd SmoothDisplacement::covariance(const Points& places, Eigen::MatrixXd* steepness) const {
  const auto [bend_mm, bend_reach_mm, fine_mm, fine_reach_mm, stretch] = scales_;
  const double bend_mm2 = bend_mm * bend_mm, bend_per_mm2 = 1 / (bend_reach_mm * bend_reach_mm),
               fine_mm2 = fine_mm * fine_mm, fine_per_mm2 = 1 / (fine_reach_mm * fine_reach_mm),
               linear = stretch * stretch;
  const Eigen::ArrayX3d from = (places.rowwise() - centre_).array();
  Eigen::MatrixXd sum(places.rows(), nodes());
  if (steepness != nullptr) steepness->resize(places.rows(), nodes());
  Eigen::ArrayXd apart_mm2(places.rows()), bend(places.rows()), fine(places.rows());
  // Column by column, so that no matrix of intermediate values goes through memory.
  for (Eigen::Index j = 0; j < nodes(); ++j) {
    const auto to = nodes_.row(j);
    apart_mm2 = (from.col(0) - to[0]).square() + (from.col(1) - to[1]).square() + (from.col(2) - to[2]).square();
    bend = bend_mm2 * (-0.5 * bend_per_mm2 * apart_mm2).exp();
    fine = fine_mm2 * (-0.5 * fine_per_mm2 * apart_mm2).exp();
    sum.col(j).array() = bend + fine + linear * (from.col(0) * to[0] + from.col(1) * to[1] + from.col(2) * to[2]) +
                         bend_mm2;  // a shift of the whole
    if (steepness != nullptr) steepness->col(j).array() = bend_per_mm2 * bend + fine_per_mm2 * fine;
  }
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
