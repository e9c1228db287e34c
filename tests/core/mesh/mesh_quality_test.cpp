#include "core/mesh/mesh_quality.h"
#include "core/mesh/repair/mesh_faults.h"

#include <doctest/doctest.h>

#include <numbers>
#include <random>

#include "core/mesh/construction/mirror.h"
#include "core/mesh/geometry/predicates.h"
#include "tests/shapes.h"

using namespace homolog;
using Pairs = std::vector<std::array<std::int32_t, 2>>;

namespace {

Mesh moved_apart_pair(const Mesh& mesh, const Vec3& shift) {
  Mesh pair;
  const Eigen::Index n = mesh.points.rows(), m = mesh.topology->triangles().rows();
  pair.points.resize(2 * n, 3);
  pair.points << mesh.points, mesh.points.rowwise() + shift.transpose();
  Triangles triangles(2 * m, 3);
  triangles << mesh.topology->triangles(), mesh.topology->triangles().array() + static_cast<std::int32_t>(n);
  pair.topology = Topology::make(2 * n, triangles).value();
  return pair;
}

/// The same surface many times at one place.
Mesh copies_of(const Mesh& mesh, int times) {
  const auto n = static_cast<std::int32_t>(mesh.points.rows());
  const Triangles& faces = mesh.topology->triangles();
  Mesh copies;
  copies.points = mesh.points.replicate(times, 1);
  Triangles triangles(times * faces.rows(), 3);
  for (int k = 0; k < times; ++k) triangles.middleRows(k * faces.rows(), faces.rows()) = faces.array() + k * n;
  copies.topology = Topology::make(copies.points.rows(), std::move(triangles)).value();
  return copies;
}

}  // namespace

TEST_CASE("orientation is exact where rounding would lose the sign") {
  const Vec3 a(0.1, 0.2, 0.3), b(12.7, 3.1, -4.4), c(-5.3, 8.8, 1.9);
  const double tiny = std::numeric_limits<double>::denorm_min() * 0x1p40;
  CHECK(orientation(a, b, c, a) == 0);
  CHECK(orientation({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, tiny}) == 1);
  CHECK(orientation({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, -tiny}) == -1);
  // Multiples of (1, 1, 1)·x lie with any two points on one plane through the origin: the sign must follow one ulp.
  const double x = 0.1, next = std::nextafter(x, 1);
  CHECK(orientation(Vec3(x, x, x), {3 * x, 3 * x, 3 * x}, {1e9, 2e9, 3e9}, {5, 6, 7}) ==
        -orientation({3 * x, 3 * x, 3 * x}, Vec3(x, x, x), {1e9, 2e9, 3e9}, {5, 6, 7}));
  using Vec2 = Eigen::Vector2d;
  CHECK(orientation(Vec2(12, 12), Vec2(24, 24), Vec2(x, x)) == 0);
  CHECK(orientation(Vec2(12, 12), Vec2(24, 24), Vec2(x, next)) == 1);
  CHECK(orientation(Vec2(12, 12), Vec2(24, 24), Vec2(next, x)) == -1);
}

TEST_CASE("a vertex stands for a third of the faces around it") {
  Mesh mesh;
  mesh.points.resize(4, 3);
  mesh.points << 0, 0, 0, 3, 0, 0, 0, 4, 0, 3, 4, 0;
  Triangles triangles(2, 3);
  triangles << 0, 1, 2, 1, 3, 2;
  mesh.topology = Topology::make(4, triangles).value();
  const VertexScalars areas_mm2 = vertex_areas_mm2(mesh);
  REQUIRE(areas_mm2.size() == 4);
  CHECK(areas_mm2[0] == doctest::Approx(2));
  CHECK(areas_mm2[1] == doctest::Approx(4));
  CHECK(areas_mm2[2] == doctest::Approx(4));
  CHECK(areas_mm2[3] == doctest::Approx(2));
  CHECK(areas_mm2.sum() == doctest::Approx(surface_area_mm2(mesh)));
}

TEST_CASE("orientation changes its sign with every swap of two points near one plane") {
  std::mt19937 engine(3);
  std::uniform_int_distribution<int> grid(0, 3);
  for (int trial = 0; trial < 500; ++trial) {
    Vec3 p[4];
    for (Vec3& q : p) q = Vec3(grid(engine), grid(engine), grid(engine)) * 0.1 + Vec3(100.3, 0.7, -3.3);
    const int sign = orientation(p[0], p[1], p[2], p[3]);
    CHECK(orientation(p[1], p[0], p[2], p[3]) == -sign);
    CHECK(orientation(p[0], p[1], p[3], p[2]) == -sign);
    CHECK(orientation(p[3], p[1], p[2], p[0]) == -sign);
    CHECK(orientation(p[1], p[2], p[0], p[3]) == sign);
  }
}

TEST_CASE("edges angles area and volume of a box are those of school") {
  const MeshQuality quality = mesh_quality(shapes::box({-10, 0, 5}, {0, 20, 35}));
  CHECK(quality.volume_ml == doctest::Approx(6));
  CHECK(quality.area_mm2 == doctest::Approx(2 * (10 * 20 + 10 * 30 + 20 * 30)));
  CHECK(quality.edge_min == doctest::Approx(10));
  CHECK(quality.edge_max == doctest::Approx(std::sqrt(20.0 * 20 + 30 * 30)));
  CHECK(quality.min_angle_deg == doctest::Approx(std::atan2(10, 30) * 180 / std::numbers::pi));
  CHECK(quality.self_intersections == 0);
  const MeshQuality even = mesh_quality(icosphere(0));
  CHECK(even.edge_cv == doctest::Approx(0).epsilon(1e-7));
  CHECK(even.edge_mean == doctest::Approx(even.edge_max));
  CHECK(even.min_angle_deg == doctest::Approx(60));
}

TEST_CASE("the volume of a sphere far from the origin converges to its formula") {
  const double exact = 4.0 / 3 * std::numbers::pi * 30 * 30 * 30 / 1000;
  const double coarse = enclosed_volume_ml(icosphere(3, 30, {1e6, -1e6, 1e6}));
  const double fine = enclosed_volume_ml(icosphere(4, 30, {1e6, -1e6, 1e6}));
  CHECK(fine == doctest::Approx(exact).epsilon(0.01));
  CHECK((exact - coarse) / (exact - fine) == doctest::Approx(4).epsilon(0.05));
}

TEST_CASE("an open tube is capped flat for its volume") {
  const Mesh tube = shapes::open_cylinder(5, 64, 10, 30);
  const double polygon = 32 * std::sin(2 * std::numbers::pi / 64) * 10 * 10;
  CHECK(enclosed_volume_ml(tube) == doctest::Approx(polygon * 30 / 1000));
  const Mesh closed = capped(tube);
  CHECK(closed.topology->closed());
  CHECK(closed.points.rows() == tube.points.rows() + 2);
  CHECK(closed.points.topRows(tube.points.rows()) == tube.points);
  CHECK(enclosed_volume_ml(closed) == doctest::Approx(enclosed_volume_ml(tube)));
  CHECK(capped(closed).topology == closed.topology);
}

TEST_CASE("normals of a sphere point outward and those of a collapsed mesh are zero") {
  Mesh sphere = icosphere(3, 5, {1, 2, 3});
  const Points normals = vertex_normals(sphere);
  for (Eigen::Index i = 0; i < normals.rows(); ++i)
    CHECK(normals.row(i).dot((sphere.points.row(i) - Eigen::RowVector3d(1, 2, 3)) / 5) > 0.999);
  sphere.points.setZero();
  CHECK(vertex_normals(sphere).isZero(0));
}

TEST_CASE("triangle quality is 1 for equilateral and 0 for degenerate triangles") {
  CHECK(triangle_quality({0, 0, 0}, {2, 0, 0}, {1, std::sqrt(3.0), 0}) == doctest::Approx(1));
  CHECK(triangle_quality({0, 0, 0}, {1, 0, 0}, {2, 0, 0}) == 0);
  CHECK(triangle_quality({1, 1, 1}, {1, 1, 1}, {1, 1, 1}) == 0);
}

TEST_CASE("shapes that do not intersect themselves have no intersecting pairs") {
  CHECK(self_intersections(icosphere(3)).empty());
  CHECK(self_intersections(shapes::torus(24, 12)).empty());
  CHECK(self_intersections(shapes::open_cylinder(6, 12)).empty());
  CHECK(self_intersections(capped(shapes::open_cylinder(6, 12))).empty());
  CHECK(self_intersections(shapes::box()).empty());
  CHECK(self_intersections(moved_apart_pair(shapes::box(), {1.0 + 1e-15, 0, 0})).empty());
}

TEST_CASE("boxes that overlap or share a side or touch in a corner intersect") {
  CHECK(!self_intersections(moved_apart_pair(shapes::box(), {0.5, 0.4, 0.3})).empty());
  CHECK(!self_intersections(moved_apart_pair(shapes::box(), {1, 0, 0})).empty());
  CHECK(!self_intersections(moved_apart_pair(shapes::box(), {1, 1, 1})).empty());
  CHECK(self_intersections(moved_apart_pair(shapes::box({0, 0, 0}, {9, 9, 9}), {0, 0, 0})).size() >= 12);
}

TEST_CASE("faces with a common vertex intersect only beyond it") {
  // Two fans' end faces around vertex 0; the middle one keeps the mesh manifold.
  const auto fan = [](const Vec3& last) {
    return shapes::make_mesh({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {-2, 0, 3}, last}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}});
  };
  CHECK(self_intersections(fan({0, -2, 1})).empty());
  CHECK(self_intersections(fan({1, 1, -1})) == Pairs{{0, 2}});     // its far edge pierces face 0
  CHECK(self_intersections(fan({-1, -2, 0})).empty());             // coplanar corner, apart
  CHECK(self_intersections(fan({0.5, 0.5, 0})) == Pairs{{0, 2}});  // an edge lies in face 0
}

TEST_CASE("faces with a common edge intersect where one is folded flat onto the other") {
  const auto hinge = [](const Vec3& tip) {
    return shapes::make_mesh({{0, 0, 0}, {2, 0, 0}, {1, 2, 0}, tip}, {{0, 1, 2}, {1, 0, 3}});
  };
  CHECK(self_intersections(hinge({1, -2, 0})).empty());
  CHECK(self_intersections(hinge({1, 1, 1e-9})).empty());
  CHECK(self_intersections(hinge({1, 1, 0})) == Pairs{{0, 1}});
}

TEST_CASE("a spike pushed through the far side is found") {
  Mesh sphere = icosphere(3, 10);
  Eigen::Index top = 0;
  sphere.points.col(2).maxCoeff(&top);
  sphere.points(top, 2) = -15;
  const auto pairs = self_intersections(sphere);
  CHECK(pairs.size() >= 6);
  for (const auto& [f, g] : pairs) CHECK(f < g);
}

TEST_CASE("copies of one surface at one place are compared up to a limit and not further") {
  const Mesh copies = copies_of(shapes::tetrahedron(10), 300);
  const SelfIntersections found = find_self_intersections(copies);
  CHECK(found.pairs.size() == most_intersections);
  CHECK_FALSE(found.all);
  CHECK(std::is_sorted(found.pairs.begin(), found.pairs.end()));
  CHECK_FALSE(mesh_quality(copies).all_intersections);
  CHECK(mesh_faults(copies).words().starts_with("at least 100000 pairs of faces that cut each other"));
  const SelfIntersections few = find_self_intersections(copies_of(shapes::tetrahedron(10), 20));
  CHECK(few.pairs.size() == 80 * 79 / 2 - 20 * 6);
  CHECK(few.all);
}

TEST_CASE("needles whose boxes all overlap do not take time with the square of their number") {
  constexpr int needles = 4000;
  std::vector<Vec3> points;
  std::vector<std::array<std::int32_t, 3>> faces;
  for (int k = 0; k < needles; ++k) {
    const Vec3 shift(0, 0, 1e-3 * k);  // parallel, so that none cuts another
    for (const Vec3& corner : {Vec3(0, 0, 0), Vec3(100, 100, 100), Vec3(100, 100.1, 100)})
      points.push_back(corner + shift);
    faces.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  const SelfIntersections found = find_self_intersections(shapes::make_mesh(points, faces));
  CHECK(found.pairs.empty());
  CHECK_FALSE(found.all);
}

TEST_CASE("mirroring twice changes nothing and once keeps faces outward and the numbering") {
  MeshFile file;
  const Mesh mesh = icosphere(2, 10, {50, 20, -30});
  file.points = mesh.points;
  file.triangles = mesh.topology->triangles();
  file.stiffness = std::make_shared<const VertexScalars>(VertexScalars::LinSpaced(file.points.rows(), 1, 5));
  file.landmarks = {{"pole", {1, 2, 3}}};
  for (const auto plane : {AnatomicalPlane::sagittal, AnatomicalPlane::coronal, AnatomicalPlane::axial}) {
    const MeshFile once = mirrored(file, plane), twice = mirrored(once, plane);
    CHECK(twice.points == file.points);
    CHECK(twice.triangles == file.triangles);
    CHECK(twice.landmarks == file.landmarks);
    CHECK(*once.stiffness == *file.stiffness);
    const Mesh other{Topology::make(once.points.rows(), once.triangles).value(), once.points};
    CHECK(enclosed_volume_ml(other) == doctest::Approx(enclosed_volume_ml(mesh)));
  }
  CHECK(mirrored(file).points.col(0) == -file.points.col(0));
  CHECK(mirrored(file).landmarks[0].position == Vec3(-1, 2, 3));
}

TEST_CASE("a search for faces that cut each other that was broken off is no sign of a sound mesh") {
  MeshFaults faults;
  CHECK_FALSE(faults.any());
  faults.all_intersections = false;
  CHECK(faults.any());
  CHECK(faults.words() == "so many faces close to each other that not all could be compared");
  faults.flat = 2;
  CHECK(faults.words() ==
        "so many faces close to each other that not all could be compared and 2 faces with an angle below 1°");
}

TEST_CASE("faults of a template are counted and said in words") {
  CHECK_FALSE(mesh_faults(icosphere(3, 20)).any());
  CHECK(mesh_faults(icosphere(3, 20)).words().empty());
  const MeshFaults spindle = mesh_faults(shapes::torus(24, 16, 5, 8));
  CHECK(spindle.any());
  CHECK(spindle.intersections > 0);
  CHECK(spindle.tunnels == 1);
  CHECK_FALSE(spindle.riddled());
  Mesh flat = icosphere(2, 20);
  const auto face = flat.topology->triangles().row(0);
  flat.points.row(face[0]) = 0.5 * (flat.points.row(face[1]) + flat.points.row(face[2]));
  CHECK(mesh_faults(flat).flat == 1);
  Mesh turned = icosphere(3, 20);
  const auto ring = turned.topology->one_ring(100);
  turned.points.row(100) = 2 * turned.points.row(ring[0]) - turned.points.row(100);
  CHECK(mesh_faults(turned).turned > 0);
  CHECK(MeshFaults{3, 0, 1, 0}.words() == "3 pairs of faces that cut each other and one face with an angle below 1°");
  CHECK(MeshFaults{1, 2, 3, 0}.words() ==
        "one pair of faces that cut each other, 2 faces that are turned over and 3 faces with an angle below 1°");
}
