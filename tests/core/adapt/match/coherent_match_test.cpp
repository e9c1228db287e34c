#include <doctest/doctest.h>

#include "core/adapt/match/coherent_match.h"
#include "core/mesh/geometry/surface_search.h"
#include "tests/adapting.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

/// A long organ with a bump on its shaft: an ellipsoid of 20 × 20 × 100 mm half axes.
Mesh shaft_with_bump(double bump_z_mm, double twist_rad) {
  Mesh shaft = icosphere(4, 20);
  for (auto p : shaft.points.rowwise()) {
    p.z() *= 5;
    const double across = p.leftCols<2>().norm(), angle = std::atan2(p.y(), p.x());
    const double away_mm = std::hypot(p.z() - bump_z_mm, 20 * angle);
    const double out_mm = 10 * std::exp(-away_mm * away_mm / (2 * 8 * 8)), turn = twist_rad * p.z() / 100;
    const double oval = 1 + 0.25 * std::cos(2 * angle);
    p.leftCols<2>() = (across * oval + out_mm) * Eigen::RowVector2d(std::cos(angle + turn), std::sin(angle + turn));
  }
  return shaft;
}

}  // namespace

TEST_CASE("a match takes a long shaft towards its twisted form") {
  const Mesh own = shaft_with_bump(30, 0), there = shaft_with_bump(30, 0.5);
  const CoherentMatch whole(own.points, own, there);
  const Points matched = whole.match(loose_match, {Points(0, 3), Points(0, 3), VertexScalars(0)}).mean();
  const double before_mm = (own.points - there.points).rowwise().norm().mean(),
               after_mm = (matched - there.points).rowwise().norm().mean();
  CAPTURE(before_mm);
  CAPTURE(after_mm);
  CHECK(after_mm < 0.8 * before_mm);
}

TEST_CASE("a match of two shapes and the match the other way meet") {
  const Mesh own = shaft_with_bump(30, 0), there = shaft_with_bump(30, 0.5);
  const KnownMatches none{Points(0, 3), Points(0, 3), VertexScalars(0)};
  const SurfaceSearch search(there);
  for (const MatchFreedom& freedom : {loose_match, close_match}) {
    const Points forth = CoherentMatch(own.points, own, there).match(freedom, none).mean(),
                 back = CoherentMatch(there.points, there, own).match(freedom, none).mean();
    double off_mm = 0;
    for (Eigen::Index i = 0; i < own.points.rows(); ++i) {
      const SurfacePoint at = search.nearest(forth.row(i).transpose()).at;
      off_mm += (at.interpolate(*there.topology, back) - own.points.row(i)).norm();
    }
    off_mm /= static_cast<double>(own.points.rows());
    CAPTURE(off_mm);
    CHECK(off_mm < 0.5);
  }
}
