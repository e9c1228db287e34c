#include "core/adapt/boundary/rim_matches.h"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/shapes.h"

using namespace homolog;

TEST_CASE("the vertices of a mesh's rims belong to the rims of an open surface") {
  const Mesh tube = shapes::open_cylinder(9, 24, 10, 40);
  Mesh shorter = tube;
  shorter.points.col(2) = 0.9 * tube.points.col(2).array() + 2;
  const Boundary boundary = mesh_boundary(tube);
  SurfaceTarget target(boundary, tube.points.rows());
  REQUIRE(target.has_rims());
  const KnownMatches one{Points::Constant(1, 3, 7), Points::Constant(1, 3, 8), VertexScalars::Constant(1, 0.5)};
  const KnownMatches known = with_rims(one, shorter, RimsLie::near, tube.points, target);
  REQUIRE(known.from.rows() == 1 + 2 * 24);
  CHECK(known.from.row(0) == one.from.row(0));
  CHECK(known.noise_mm[0] == 0.5);
  for (Eigen::Index k = 1; k < known.to.rows(); ++k) {
    CHECK(std::abs(known.to(k, 2) - (known.from(k, 2) < 20 ? 0 : 40)) < 1e-9);
    CHECK((known.to.row(k) - known.from.row(k)).norm() < 1e-6);  // they are told of the mesh as it started
    CHECK(known.noise_mm[k] > 0);
  }
}

TEST_CASE("rims tell nothing of a closed surface, nor of one that may lack parts") {
  const Mesh tube = shapes::open_cylinder(9, 24, 10, 40), ball = icosphere(2, 10);
  const Boundary open = mesh_boundary(tube), closed = mesh_boundary(ball);
  SurfaceTarget lacking(open, tube.points.rows(), true), whole(closed, ball.points.rows());
  CHECK_FALSE(lacking.has_rims());
  CHECK_FALSE(whole.has_rims());
  CHECK(with_rims({}, tube, RimsLie::near, tube.points, lacking).from.rows() == 0);
  CHECK(with_rims({}, tube, RimsLie::on_each_other, tube.points, whole).from.rows() == 0);
}
