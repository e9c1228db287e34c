#include "core/mesh/repair/mesh_repair.h"

#include <doctest/doctest.h>

#include <array>
#include <limits>
#include <map>
#include <random>

#include "core/mesh/mesh_quality.h"
#include "tests/cpu_time.h"
#include "tests/refusal.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

MeshFile as_file(const Mesh& mesh) {
  MeshFile file;
  file.points = mesh.points;
  file.triangles = mesh.topology->triangles();
  return file;
}

/// Both in one file, vertices of the second after those of the first.
MeshFile both(const MeshFile& a, const MeshFile& b) {
  MeshFile file;
  file.points.resize(a.points.rows() + b.points.rows(), 3);
  file.points << a.points, b.points;
  Triangles& faces = file.triangles.edit();
  faces.resize(a.triangles.rows() + b.triangles.rows(), 3);
  faces << *a.triangles, (b.triangles->array() + static_cast<std::int32_t>(a.points.rows())).matrix();
  return file;
}

/// Vertices at one place made one.
MeshFile merged(MeshFile file) {
  std::map<std::array<double, 3>, std::int32_t> first;
  std::vector<std::int32_t> number;
  for (const auto p : file.points.rowwise())
    number.push_back(first.try_emplace({p[0], p[1], p[2]}, static_cast<std::int32_t>(first.size())).first->second);
  Points points(std::ssize(first), 3);
  for (const auto& [place, v] : first) points.row(v) << place[0], place[1], place[2];
  file.points = std::move(points);
  for (std::int32_t& v : file.triangles.edit().reshaped()) v = number[static_cast<std::size_t>(v)];
  return file;
}

MeshFile with_face(MeshFile file, std::int32_t a, std::int32_t b, std::int32_t c) {
  Triangles& faces = file.triangles.edit();
  faces.conservativeResize(faces.rows() + 1, 3);
  faces.bottomRows(1) << a, b, c;
  return file;
}

}  // namespace

TEST_CASE("a sound surface is repaired to itself") {
  const Mesh ball = icosphere(2, 10);
  const MeshRepair repair = repaired(as_file(ball)).value();
  CHECK_FALSE(repair.mended.any());
  CHECK(repair.mended.words().empty());
  CHECK(repair.mesh.points == ball.points);
  CHECK(repair.mesh.topology->hash() == ball.topology->hash());
}

TEST_CASE("vertices that are no numbers go with their faces and the hole is closed") {
  const Mesh ball = icosphere(2, 10);
  MeshFile file = as_file(ball);
  file.points(5, 1) = std::numeric_limits<double>::quiet_NaN();
  const MeshRepair repair = repaired(file).value();
  CHECK(repair.mended.not_finite == 1);
  CHECK(repair.mended.holes == 1);
  CHECK(repair.mesh.topology->closed());
  CHECK(enclosed_volume_ml(repair.mesh) == doctest::Approx(enclosed_volume_ml(ball)).epsilon(0.02));
}

TEST_CASE("duplicate vertices and faces and faces without area are left out") {
  const Mesh ball = icosphere(2, 10);
  MeshFile soup;
  const Triangles& faces = ball.topology->triangles();
  soup.points.resize(3 * faces.rows(), 3);
  Triangles& own = soup.triangles.edit();
  own.resize(faces.rows(), 3);
  for (Eigen::Index f = 0; f < faces.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      soup.points.row(3 * f + k) = ball.points.row(faces(f, k));
      own(f, k) = static_cast<std::int32_t>(3 * f + k);
    }
  soup = with_face(with_face(soup, 2, 0, 1), 3, 3, 4);
  soup.points.conservativeResize(soup.points.rows() + 1, 3);
  soup.points.bottomRows(1).setZero();
  const MeshRepair repair = repaired(soup).value();
  CHECK(repair.mended.duplicate_vertices == static_cast<std::size_t>(3 * faces.rows() - ball.points.rows()));
  CHECK(repair.mended.unused_vertices == 1);
  CHECK(repair.mended.duplicate_faces == 1);
  CHECK(repair.mended.degenerate_faces == 1);
  CHECK(repair.mesh.points.rows() == ball.points.rows());
  CHECK(repair.mesh.topology->genus() == 0);
}

TEST_CASE("triangles whose corners nearly meet are one surface") {
  const Mesh ball = icosphere(2, 10);
  std::mt19937 random(1);
  // Both as near as the rounding of single precision and up to what counts as one place.
  for (const double apart_mm : {2e-7, 5e-6}) {
    std::uniform_real_distribution<double> jitter(-apart_mm, apart_mm);
    MeshFile soup;
    const Triangles& faces = ball.topology->triangles();
    soup.points.resize(3 * faces.rows(), 3);
    Triangles& own = soup.triangles.edit();
    own.resize(faces.rows(), 3);
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
      for (int c = 0; c < 3; ++c) {
        const Vec3 off(jitter(random), jitter(random), jitter(random));
        soup.points.row(3 * f + c) = ball.points.row(faces(f, c)) + off.transpose();
        own(f, c) = static_cast<std::int32_t>(3 * f + c);
      }
    const MeshRepair repair = mended_if_broken(soup).value();
    CHECK(repair.mesh.topology->closed());
    CHECK(repair.mesh.points.rows() == ball.points.rows());
    CHECK(repair.mended.holes == 0);
  }
}

TEST_CASE("boxes that touch along an edge or at a corner come apart") {
  const MeshFile one = as_file(shapes::box());
  const auto apart = [&](const Vec3& low, const Vec3& high) {
    const MeshRepair repair = repaired(merged(both(one, as_file(shapes::box(low, high))))).value();
    CHECK(repair.mesh.topology->components() == 2);
    CHECK(repair.mesh.topology->closed());
    CHECK(enclosed_volume_ml(repair.mesh) == doctest::Approx(0.002).epsilon(0.02));
    CHECK(self_intersections(repair.mesh).empty());
    CHECK(repair.mended.turned_faces == 0);
    return repair.mended;
  };
  const MendedFaults edge = apart(Vec3(1, 1, 0), Vec3(2, 2, 1));
  CHECK(edge.non_manifold_edges == 1);
  const MendedFaults corner = apart(Vec3(1, 1, 1), Vec3(2, 2, 2));
  CHECK(corner.non_manifold_vertices == 1);
  CHECK(corner.non_manifold_edges == 0);
}

TEST_CASE("a surface that touches itself along a single edge becomes a manifold") {
  // A frame of voxels whose first and last touch along an edge only: the same vertices on both sides of it.
  const std::vector<Vec3> cells{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {2, 2, 0},
                                {1, 2, 0}, {0, 2, 0}, {0, 2, 1}, {0, 1, 1}};
  MeshFile file;
  for (const Vec3& cell : cells) {
    const MeshFile voxel = as_file(shapes::box(cell, cell + Vec3::Ones()));
    file = file.points.rows() == 0 ? voxel : both(file, voxel);
  }
  const MeshRepair solid = repaired(merged(file)).value();
  CHECK(solid.mesh.topology->closed());
  CHECK(self_intersections(solid.mesh).empty());
  CHECK(solid.mesh.topology->components() == 1);
  CHECK(solid.mended.non_manifold_edges == 1);
  CHECK(solid.mended.duplicate_faces == 4 * (cells.size() - 1));  // walls between neighbours
  CHECK(enclosed_volume_ml(solid.mesh) == doctest::Approx(0.001 * static_cast<double>(cells.size())).epsilon(0.02));
}

TEST_CASE("a fin on a ball comes off it and the ball is closed") {
  const Mesh ball = icosphere(2, 10);
  MeshFile file = as_file(ball);
  const auto edge = ball.topology->edges()[7];
  file.points.conservativeResize(file.points.rows() + 1, 3);
  file.points.bottomRows(1) = 1.05 * (file.points.row(edge[0]) + file.points.row(edge[1])) / 2;
  file = with_face(file, edge[0], edge[1], static_cast<std::int32_t>(file.points.rows() - 1));
  const MeshRepair repair = repaired(file).value();
  CHECK(repair.mended.non_manifold_edges == 1);
  CHECK(repair.mended.crumbs == 1);
  CHECK(repair.mesh.topology->closed());
  CHECK(repair.mesh.topology->components() == 1);
  CHECK(repair.mesh.points.rows() == ball.points.rows());
}

TEST_CASE("faces that look against each other are turned outward") {
  const Mesh ball = icosphere(2, 10);
  MeshFile file = as_file(ball);
  std::mt19937 random(2);
  Triangles& faces = file.triangles.edit();
  for (Eigen::Index f = 0; f < faces.rows(); ++f)
    if (random() % 3 == 0) std::swap(faces(f, 1), faces(f, 2));
  const MeshRepair repair = repaired(file).value();
  CHECK(repair.mended.turned_faces > 50);
  CHECK(enclosed_volume_ml(repair.mesh) == doctest::Approx(enclosed_volume_ml(ball)));
  MeshFile inward = as_file(ball);
  inward.triangles = (*inward.triangles)(Eigen::all, std::array{0, 2, 1});
  CHECK(enclosed_volume_ml(repaired(inward).value().mesh) > 0);
  CHECK(repaired(inward).value().mended.turned_faces == static_cast<std::size_t>(inward.triangles.rows()));
}

TEST_CASE("a band with one side only is cut") {
  MeshFile band;
  const int steps = 24;
  band.points.resize(2 * steps, 3);
  Triangles& faces = band.triangles.edit();
  faces.resize(2 * steps, 3);
  for (int s = 0; s < steps; ++s) {
    const double u = 2 * std::numbers::pi * s / steps;
    for (int side = 0; side < 2; ++side) {
      const double w = 10 + (side == 0 ? 1 : -1) * std::cos(u / 2);
      band.points.row(2 * s + side) << w * std::cos(u), w * std::sin(u), (side == 0 ? 1 : -1) * std::sin(u / 2);
    }
    const auto next = [&](int side) { return s + 1 < steps ? 2 * (s + 1) + side : 1 - side; };
    faces.row(2 * s) << 2 * s, next(0), 2 * s + 1;
    faces.row(2 * s + 1) << 2 * s + 1, next(0), next(1);
  }
  CHECK_FALSE(Topology::make(band.points.rows(), band.triangles));
  const MeshRepair repair = repaired(band, {-1}).value();
  CHECK(repair.mesh.topology->rims().size() == 1);
}

TEST_CASE("crumbs and cavities go and parts of some size stay") {
  const MeshFile ball = as_file(icosphere(3, 10)), crumb = as_file(icosphere(1, 0.5, Vec3(20, 0, 0))),
                 other = as_file(icosphere(2, 4, Vec3(0, 20, 0)));
  MeshFile cavity = as_file(icosphere(2, 4, Vec3(1, 0, 0)));
  cavity.triangles = (*cavity.triangles)(Eigen::all, std::array{0, 2, 1});
  const MeshRepair repair = repaired(both(both(ball, crumb), both(other, cavity))).value();
  CHECK(repair.mended.crumbs == 1);
  CHECK(repair.mended.cavities == 1);
  CHECK(repair.mesh.topology->components() == 2);
  CHECK(repair.mended.words() == "one crumb left out and one cavity filled");
  // A sheet within another that looks outward, as an endocardium does, is no cavity.
  const MeshRepair sheets = repaired(both(ball, as_file(icosphere(2, 4)))).value();
  CHECK_FALSE(sheets.mended.any());
}

TEST_CASE("small holes are closed and an open base is not") {
  const MeshFile tube = as_file(shapes::open_cylinder(10, 24, 10, 40));
  CHECK(repaired(tube, {small_rim_share}).value().mended.holes == 0);
  CHECK(repaired(tube).value().mended.holes == 2);
  MeshFile pierced = tube;
  Triangles& faces = pierced.triangles.edit();
  faces.conservativeResize(faces.rows() / 2 + 1, 3);
  faces.row(faces.rows() / 2) = faces.row(0);
  const MeshRepair repair = repaired(pierced, {small_rim_share}).value();
  CHECK(repair.mended.holes == 1);
  CHECK(repair.mended.duplicate_faces == 1);
  CHECK(repair.mesh.topology->rims().size() == 2);
}

TEST_CASE("a face without area has its longest edge flipped") {
  // A box whose lower edge has one more corner in its middle, with a flat face along it.
  const Mesh box = shapes::box();
  MeshFile file = as_file(box);
  file.points.conservativeResize(9, 3);
  file.points.row(8) << 0.5, 0, 0;
  file.triangles.edit().row(4) << 0, 8, 4;  // was 0 1 4
  file = with_face(with_face(file, 8, 1, 4), 0, 1, 8);
  const MeshRepair repair = repaired(file).value();
  CHECK(repair.mended.degenerate_faces == 1);
  CHECK(repair.mesh.topology->closed());
  for (Eigen::Index f = 0; f < repair.mesh.topology->triangles().rows(); ++f)
    CHECK(smallest_angle_deg(repair.mesh, f) > 1);
}

TEST_CASE("two flips that would make one edge do not keep others from being made") {
  // Around a double pyramid two faces without area have their long edges opposite each other: flipping both would join
  // the tips twice.
  const Mesh pyramid =
      shapes::make_mesh({{0, 0, 0}, {0, 0, -5}, {-5, 0, 0}, {5, 0, 0}, {0, -5, 0}, {0, 5, 0}},
                        {{0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 2}, {1, 3, 2}, {1, 4, 3}, {1, 5, 4}, {1, 2, 5}});
  Mesh ball = icosphere(2, 5);
  const auto face = ball.topology->triangles().row(0);
  ball.points.row(face[0]) = (ball.points.row(face[1]) + ball.points.row(face[2])) / 2;
  ball.points.rowwise() += Eigen::RowVector3d(30, 0, 0);
  const MeshRepair repair = repaired(as_file(joined({pyramid, ball}))).value();
  CHECK(repair.mended.degenerate_faces == 2);
}

TEST_CASE("of two parts those inside out are turned and counted once whichever is the larger") {
  const auto inside_out = [](MeshFile file) {
    file.triangles = (*file.triangles)(Eigen::all, std::array{0, 2, 1});
    return file;
  };
  Mesh other = icosphere(2, 8);
  other.points.rowwise() += Eigen::RowVector3d(30, 0, 0);
  const MeshFile large = as_file(icosphere(2, 10)), small = as_file(other);
  for (const MeshFile& file : {both(inside_out(large), small), both(large, inside_out(small))}) {
    const MeshRepair repair = repaired(file).value();
    CHECK(repair.mended.turned_faces == static_cast<std::size_t>(large.triangles.rows()));
    CHECK(repair.mended.cavities == 0);
    for (const Mesh& part : parts_of(repair.mesh)) CHECK(enclosed_volume_ml(part) > 0);
  }
}

TEST_CASE("parts are grouped by boxes that meet and the largest group comes first") {
  Mesh small = icosphere(1, 3), near = small, far = small;
  near.points.rowwise() += Eigen::RowVector3d(10, 0, 0);
  far.points.rowwise() += Eigen::RowVector3d(50, 0, 0);
  const std::vector<Mesh> groups = neighbouring_parts(joined({far, near, icosphere(2, 10)}));
  REQUIRE(groups.size() == 2);
  CHECK(groups.front().topology->components() == 2);
  CHECK(groups.back().points == far.points);
}

TEST_CASE("random faces over few vertices become a manifold whatever they are") {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    std::mt19937 random(seed);
    MeshFile file;
    const auto vertices = static_cast<std::int32_t>(4 + random() % 12);
    file.points.resize(vertices, 3);
    for (double& x : file.points.reshaped()) x = static_cast<double>(random() % 1000);
    Triangles& faces = file.triangles.edit();
    faces.resize(static_cast<Eigen::Index>(4 + random() % 80), 3);
    for (std::int32_t& v : faces.reshaped()) v = static_cast<std::int32_t>(random() % vertices);
    const auto repair = repaired(file, {-1});
    if (!repair) continue;
    // Topology::make has checked it; again it is sound as it is.
    CHECK(sound_mesh(as_file(repair->mesh)).has_value());
  }
}

TEST_CASE("a surface without extent is refused") {
  MeshFile point = as_file(icosphere(0, 10));
  point.points.setConstant(3);
  CHECK(says(repaired(point), "has no extent"));
}

TEST_CASE("a surface without a face is refused") {
  MeshFile file = as_file(shapes::tetrahedron());
  Triangles& faces = file.triangles.edit();
  faces.col(0) = faces.col(1);
  CHECK(says(repaired(file), "has no face left"));
}

TEST_CASE("many copies of one surface at one place are welded in little time") {
  const Mesh one = shapes::tetrahedron(10);
  constexpr int times = 60000;
  MeshFile copies;
  copies.points = one.points.replicate(times, 1);
  Triangles& faces = copies.triangles.edit();
  faces.resize(4 * times + 2, 3);
  for (int k = 0; k < times; ++k) faces.middleRows(4 * k, 4) = one.topology->triangles().array() + 4 * k;
  faces.bottomRows(2) = faces.topRows(1).replicate(2, 1);  // so that the surface is not sound
  Result<MeshRepair> repair = fail("", "");
  // Seven thousand million pairs of vertices lie at one place.
  CHECK(test::cpu_seconds_of([&] { repair = repaired(copies); }) < 4);
  REQUIRE(repair);
  CHECK(repair->mesh.points.rows() == 4);
  CHECK(repair->mended.duplicate_vertices == 4 * (times - 1));
}
