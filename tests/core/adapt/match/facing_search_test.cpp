#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/adapt/match/facing_search.h"
#include "core/mesh/icosphere.h"
#include "core/mesh/surface_search.h"

using namespace homolog;

namespace {

constexpr double ridge_mm = 35;  ///< along z

/// A long organ with a ridge around its shaft: an ellipsoid of 20 × 20 × 60 mm half axes, turned by `turn_rad` around
/// x, the more so the farther up.
Mesh shaft_with_ridge(double turn_rad) {
  Mesh shaft = icosphere(5, 20);
  for (auto p : shaft.points.rowwise()) {
    p.z() *= 3;
    const double from_ridge_mm = p.z() - ridge_mm;
    p.leftCols<2>() *= 1 + 0.3 * std::exp(-from_ridge_mm * from_ridge_mm / (2 * 5 * 5));
    const double turn = turn_rad * (p.z() + 60) / 120;
    p = (Eigen::AngleAxisd(turn, Vec3::UnitX()) * p.transpose()).transpose().eval();
  }
  return shaft;
}

/// How far apart two n×3 lie near the ridge: root mean square, mm.
double apart_at_ridge_mm(const Mesh& upright, const Points& a, const Points& b) {
  double sum_mm2 = 0, count = 0;
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    if (std::abs(upright.points(i, 2) - ridge_mm) > 8) continue;
    sum_mm2 += (a.row(i) - b.row(i)).squaredNorm();
    ++count;
  }
  return std::sqrt(sum_mm2 / count);
}

}  // namespace

TEST_CASE("vertices that slid off a ridge are drawn back to it, on a bent organ too") {
  const Mesh own = shaft_with_ridge(0);
  for (const double turn_rad : {0.0, 1.0}) {
    CAPTURE(turn_rad);
    const Mesh there = shaft_with_ridge(turn_rad);
    Points slid = there.points;
    slid.rowwise() += Eigen::RowVector3d(0, 0, 2.5);
    const SurfaceSearch search(there);
    for (Eigen::Index i = 0; i < slid.rows(); ++i) slid.row(i) = search.nearest(slid.row(i).transpose()).position;
    const BoundaryPull pull = FacingSearch(there, own.points.rows()).pull(own, {own.topology, slid});
    const double before_mm = apart_at_ridge_mm(own, slid, there.points),
                 after_mm = apart_at_ridge_mm(own, pull.targets, there.points);
    CAPTURE(before_mm);
    CAPTURE(after_mm);
    CHECK(after_mm < 0.75 * before_mm);
  }
}

TEST_CASE("where a surface is flat its direction holds vertices weakly, and an edge tells far more") {
  Mesh box = icosphere(5, 15);  // a cube of 30 mm with edges that are a little round
  for (auto p : box.points.rowwise()) p *= 15 / std::pow(p.array().abs().pow(12).sum(), 1.0 / 12);
  const BoundaryPull pull = FacingSearch(box, box.points.rows()).pull(box, box);
  double flat = 0, edge = 0;
  for (Eigen::Index i = 0; i < box.points.rows(); ++i) {
    const Vec3 p = box.points.row(i).transpose().cwiseAbs();
    if ((p - Vec3(15, 0, 0)).norm() < 3) flat = pull.weights[i];
    if ((p - Vec3(15, 15, 0)).norm() < 3) edge = pull.weights[i];
  }
  CHECK(flat > 0);
  CHECK(edge > 1.8 * flat);
}
