#include "core/mesh/topology.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <initializer_list>
#include <random>
#include <set>

#include "core/mesh/closed_mesh.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

Triangles faces(std::initializer_list<std::array<std::int32_t, 3>> list) {
  Triangles triangles(static_cast<Eigen::Index>(list.size()), 3);
  Eigen::Index f = 0;
  for (const auto& t : list) triangles.row(f++) << t[0], t[1], t[2];
  return triangles;
}

std::string refusal(Eigen::Index vertices, const Triangles& triangles) {
  const auto made = Topology::make(vertices, triangles);
  return made ? "" : made.error().what;
}

void check_against_faces(const Topology& topology) {
  std::vector<std::set<std::int32_t>> rings(static_cast<std::size_t>(topology.vertices()));
  std::set<std::array<std::int32_t, 2>> edges;
  const Triangles& t = topology.triangles();
  for (Eigen::Index f = 0; f < t.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = t(f, k), b = t(f, (k + 1) % 3);
      rings[static_cast<std::size_t>(a)].insert(b);
      rings[static_cast<std::size_t>(b)].insert(a);
      edges.insert({std::min(a, b), std::max(a, b)});
      const std::int32_t across = topology.neighbours(f)[static_cast<std::size_t>(k)];
      if (across < 0) continue;
      const auto back = topology.neighbours(across);
      const auto corner = std::find(back.begin(), back.end(), f) - back.begin();
      REQUIRE(corner < 3);
      CHECK(t(across, corner) == b);
      CHECK(t(across, (corner + 1) % 3) == a);
    }
  }
  CHECK(std::equal(edges.begin(), edges.end(), topology.edges().begin(), topology.edges().end()));
  for (std::int32_t v = 0; v < topology.vertices(); ++v) {
    const auto& ring = rings[static_cast<std::size_t>(v)];
    CHECK(std::equal(ring.begin(), ring.end(), topology.one_ring(v).begin(), topology.one_ring(v).end()));
    for (const std::int32_t f : topology.faces_of(v)) CHECK((t.row(f).array() == v).any());
    CHECK(topology.faces_of(v).size() == ring.size() - (topology.on_rim(v) ? 1 : 0));
  }
}

}  // namespace

TEST_CASE("edges rings faces and neighbours agree with the triangles") {
  check_against_faces(*shapes::tetrahedron().topology);
  check_against_faces(*icosphere(2).topology);
  check_against_faces(*shapes::torus(8, 5).topology);
  check_against_faces(*shapes::open_cylinder(4, 7).topology);
}

TEST_CASE("closed shapes have the genus and the components that they are made with") {
  CHECK(icosphere(2).topology->genus() == 0);
  CHECK(shapes::torus(8, 6).topology->genus() == 1);
  CHECK(shapes::torus(8, 6).topology->closed());
  const Mesh a = shapes::tetrahedron();
  Triangles two(8, 3);
  two << a.topology->triangles(), a.topology->triangles().array() + 4;
  const auto pair = Topology::make(8, two).value();
  CHECK(pair->components() == 2);
  CHECK(pair->genus() == 0);
  CHECK(pair->component() == std::vector<std::int32_t>{0, 0, 0, 0, 1, 1, 1, 1});
}

TEST_CASE("a mesh with a rim is no closed mesh, and one without is seen as it is") {
  const Mesh ball = icosphere(1), tube = shapes::open_cylinder(3, 6), nothing{};
  const auto closed = ClosedMesh::of(ball);
  REQUIRE(closed);
  CHECK(&closed->mesh() == &ball);
  CHECK(&closed->points() == &ball.points);
  CHECK_FALSE(ClosedMesh::of(tube));
  CHECK_FALSE(ClosedMesh::of(nothing));
}

TEST_CASE("an open tube has two boundary loops that run with its faces") {
  const Mesh tube = shapes::open_cylinder(3, 6);
  const auto& loops = tube.topology->rims();
  REQUIRE(loops.size() == 2);
  CHECK(tube.topology->genus() == 0);
  CHECK(loops[0] == std::vector<std::int32_t>{0, 1, 2, 3, 4, 5});
  CHECK(loops[1] == std::vector<std::int32_t>{12, 17, 16, 15, 14, 13});
  CHECK(tube.topology->on_rim(0));
  CHECK(!tube.topology->on_rim(7));
}

TEST_CASE("the hash tells numberings apart and nothing else") {
  const auto triangles = icosphere(1).topology->triangles();
  Triangles turned = triangles;
  turned.row(3) << triangles(3, 1), triangles(3, 2), triangles(3, 0);
  CHECK(Topology::make(42, triangles).value()->hash() == icosphere(1, 7).topology->hash());
  CHECK(Topology::make(42, triangles).value()->hash() != Topology::make(42, turned).value()->hash());
  CHECK(Topology::make(42, triangles).value()->hash().size() == 16);
}

TEST_CASE("what is no oriented manifold is refused with the first offender named") {
  CHECK(refusal(0, Triangles(0, 3)).find("no faces") != std::string::npos);
  CHECK(refusal(3, faces({{0, 1, 3}})).find("names vertex 3 of 3") != std::string::npos);
  CHECK(refusal(3, faces({{0, -1, 2}})).find("vertex -1") != std::string::npos);
  CHECK(refusal(3, faces({{0, 1, 1}})).find("vertex 1 twice") != std::string::npos);
  CHECK(refusal(4, faces({{0, 1, 2}})).find("vertex 3 belongs to no face") != std::string::npos);
  CHECK(refusal(5, faces({{0, 1, 2}, {1, 0, 3}, {0, 1, 4}})).find("edge 0-1 has 3 faces") != std::string::npos);
  CHECK(refusal(4, faces({{0, 1, 2}, {0, 1, 3}})).find("faces 0 and 1 at edge 0-1") != std::string::npos);
  CHECK(refusal(3, faces({{0, 1, 2}, {0, 1, 2}})).find("oriented against") != std::string::npos);
  CHECK(refusal(5, faces({{0, 1, 2}, {0, 3, 4}})).find("vertex 0 joins two parts") != std::string::npos);
}

TEST_CASE("two closed parts that touch in one vertex are refused") {
  const Triangles one = shapes::tetrahedron().topology->triangles();
  Triangles two(8, 3);
  two << one, (one.array() == 0).select(Triangles::Zero(4, 3), one.array() + 3);
  CHECK(refusal(7, two).find("vertex 0 joins two parts") != std::string::npos);
}
