#include "core/placement/similarity_fit.h"

#include <Eigen/SVD>
#include <cassert>
#include <cmath>

namespace homolog {

namespace {

/// Share of the spread across the main line below which points count as collinear.
constexpr double collinear_share = 0.02;

Similarity centred(const Eigen::Quaterniond& rotation, double scale, const Vec3& from, const Vec3& to) {
  return {rotation, scale, to - scale * (rotation * from)};
}

}  // namespace

Similarity fit_similarity(const Points& from, const Points& to, const Similarity& current) {
  assert(from.rows() == to.rows());
  if (from.rows() == 0) return current;
  const Vec3 from_centre = from.colwise().mean(), to_centre = to.colwise().mean();
  const Points a = from.rowwise() - from_centre.transpose(), b = to.rowwise() - to_centre.transpose();
  const double from_spread = a.norm(), to_spread = b.norm();
  if (from.rows() == 1 || from_spread < 1e-9 || to_spread < 1e-9) {
    return centred(current.rotation, current.scale, from_centre, to_centre);
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> shape_a(a, Eigen::ComputeThinV), shape_b(b, Eigen::ComputeThinV);
  const auto line_only = [](const auto& svd) {
    return svd.singularValues()[1] < collinear_share * svd.singularValues()[0];
  };
  if (from.rows() == 2 || line_only(shape_a) || line_only(shape_b)) {
    const Vec3 line_from = current.rotation * Vec3(shape_a.matrixV().col(0));
    Vec3 line_to = shape_b.matrixV().col(0);
    const double same_way = ((a * shape_a.matrixV().col(0)).transpose() * (b * line_to))(0);
    if (same_way < 0) line_to = -line_to;
    const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(line_from, line_to);
    return centred((turn * current.rotation).normalized(), to_spread / from_spread, from_centre, to_centre);
  }
  const Eigen::JacobiSVD<Mat3> svd(b.transpose() * a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vec3 sign = Vec3::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) sign[2] = -1;
  const Mat3 rotation = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  const double scale = svd.singularValues().dot(sign) / (from_spread * from_spread);
  return centred(Eigen::Quaterniond(rotation).normalized(), scale, from_centre, to_centre);
}

}  // namespace homolog
