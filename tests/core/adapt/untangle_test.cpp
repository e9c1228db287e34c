#include <doctest/doctest.h>

#include "core/adapt/untangle.h"
#include "core/deform/fold_guard.h"
#include "core/mesh/mesh_quality.h"
#include "tests/shapes.h"

using namespace homolog;

TEST_CASE("untangling frees turned triangles and leaves the rest") {
  const Mesh sphere = icosphere(3);
  Mesh tangled = sphere;
  const auto ring = sphere.topology->one_ring(100);
  tangled.points.row(100) = 2 * sphere.points.row(ring[0]) - sphere.points.row(100);
  REQUIRE(!turned_triangles(*sphere.topology, sphere.points, tangled.points).empty());
  CHECK(untangle(tangled, sphere.points, VertexScalars::Ones(sphere.points.rows())));
  CHECK(turned_triangles(*sphere.topology, sphere.points, tangled.points).empty());
  CHECK(self_intersections(tangled).empty());
  Eigen::Index moved = 0;
  const VertexScalars way = (tangled.points - sphere.points).rowwise().norm();
  for (Eigen::Index i = 0; i < way.size(); ++i) moved += way[i] > 0.01;
  CHECK(moved < sphere.points.rows() / 4);
}
