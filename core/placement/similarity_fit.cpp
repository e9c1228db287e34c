#include "core/placement/similarity_fit.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/base/demand.h"
#include "core/base/numbers/rotation.h"

namespace homolog {

namespace {

/// Share of the spread across the main line below which points count as collinear.
constexpr double collinear_share = 0.02;

Similarity centred(const Eigen::Quaterniond& rotation, double scale, const Vec3& from, const Vec3& to) {
  return {rotation, scale, to - scale * (rotation * from)};
}

/// The line that points lie along: n×3, centred.
struct MainLine {
  Vec3 direction;
  bool only;  ///< next to nothing lies across it
};
MainLine main_line(const Points& points) {
  const Eigen::SelfAdjointEigenSolver<Mat3> spread(points.transpose() * points);
  return {spread.eigenvectors().col(2),
          spread.eigenvalues()[1] < collinear_share * collinear_share * spread.eigenvalues()[2]};
}

}  // namespace

Similarity nearest_similarity(const Points& from, const Points& to, const Similarity& current) {
  demand(from.rows() == to.rows(), "there are other points to be carried than places for them; give as many of both");
  if (from.rows() == 0) return current;
  const Vec3 from_centre = from.colwise().mean(), to_centre = to.colwise().mean();
  const Points a = from.rowwise() - from_centre.transpose(), b = to.rowwise() - to_centre.transpose();
  const double from_spread = a.norm(), to_spread = b.norm();
  if (from.rows() == 1 || from_spread < 1e-9 || to_spread < 1e-9) {
    return centred(current.rotation, current.scale, from_centre, to_centre);
  }
  const MainLine line_a = main_line(a), line_b = main_line(b);
  const Mat3 covariance = b.transpose() * a;
  if (from.rows() == 2 || line_a.only || line_b.only) {
    const bool same_way = line_b.direction.dot(covariance * line_a.direction) >= 0;
    const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(
        current.rotation * line_a.direction, same_way ? line_b.direction : Vec3(-line_b.direction));
    return centred((turn * current.rotation).normalized(), to_spread / from_spread, from_centre, to_centre);
  }
  const Mat3 rotation = nearest_rotation(covariance);
  const double scale = rotation.cwiseProduct(covariance).sum() / (from_spread * from_spread);
  return centred(Eigen::Quaterniond(rotation).normalized(), scale, from_centre, to_centre);
}

}  // namespace homolog
