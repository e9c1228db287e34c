#include "core/template_making/mesh_template.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "core/mesh/construction/remesh.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/repair/mesh_faults.h"
#include "core/mesh/repair/mesh_repair.h"
#include "core/template_making/solid_voxels.h"
#include "core/template_making/tunnels.h"
#include "tests/cpu_time.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

MeshTemplateOptions with_vertices(int vertices, GenusRule genus = {}) {
  MeshTemplateOptions options;
  options.vertices = vertices;
  options.genus = genus;
  return options;
}

MeshFile surface_file(const Mesh& mesh) {
  MeshFile file;
  file.points = mesh.points;
  file.triangles = mesh.topology->triangles();
  return file;
}

/// The outer faces of voxels, two triangles each, corners shared: where voxels touch along an edge it has four faces.
MeshFile voxel_faces(const std::vector<std::uint8_t>& set, const std::array<int, 3>& dims, double voxel_mm) {
  const auto at = [&](int i, int j, int k) {
    if (i < 0 || j < 0 || k < 0 || i >= dims[0] || j >= dims[1] || k >= dims[2]) return false;
    return set[static_cast<std::size_t>((k * dims[1] + j) * dims[0] + i)] != 0;
  };
  std::map<std::array<int, 3>, std::int32_t> corners;
  std::vector<std::array<int, 3>> places;
  std::vector<std::array<std::int32_t, 3>> faces;
  const auto corner = [&](const std::array<int, 3>& place) {
    const auto [found, is_new] = corners.try_emplace(place, static_cast<std::int32_t>(places.size()));
    if (is_new) places.push_back(place);
    return found->second;
  };
  for (int k = 0; k < dims[2]; ++k)
    for (int j = 0; j < dims[1]; ++j)
      for (int i = 0; i < dims[0]; ++i)
        for (std::size_t axis = 0; axis < 3 && at(i, j, k); ++axis)
          for (const int side : {0, 1}) {
            std::array<int, 3> beside{i, j, k};
            beside[axis] += side == 0 ? -1 : 1;
            if (at(beside[0], beside[1], beside[2])) continue;
            std::array<std::int32_t, 4> square{};
            for (std::size_t c = 0; c < 4; ++c) {
              std::array<int, 3> place{i, j, k};
              place[axis] += side;
              place[(axis + 1) % 3] += c == 1 || c == 2;
              place[(axis + 2) % 3] += c >= 2;
              square[c] = corner(place);
            }
            if (side == 0) std::swap(square[1], square[3]);
            faces.push_back({square[0], square[1], square[2]});
            faces.push_back({square[0], square[2], square[3]});
          }
  MeshFile file;
  file.points.resize(static_cast<Eigen::Index>(places.size()), 3);
  for (std::size_t v = 0; v < places.size(); ++v)
    for (std::size_t axis = 0; axis < 3; ++axis)
      file.points(static_cast<Eigen::Index>(v), static_cast<Eigen::Index>(axis)) = voxel_mm * places[v][axis];
  Triangles& triangles = file.triangles.edit();
  triangles.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f)
    triangles.row(static_cast<Eigen::Index>(f)) << faces[f][0], faces[f][1], faces[f][2];
  return file;
}

/// A skull as a CT of a mouse shows it: `length_mm` long, walls two voxels thin, a large hole behind, hundreds of pores
/// through the walls, loose voxels, and voxels that touch along edges only.
MeshFile thin_skull(double voxel_mm, double length_mm = 20, double pores = 0.04) {
  const std::array<int, 3> dims{static_cast<int>(1.1 * length_mm / voxel_mm),
                                static_cast<int>(0.6 * length_mm / voxel_mm),
                                static_cast<int>(0.55 * length_mm / voxel_mm)};
  std::mt19937 random(7);
  const auto share = [&random] { return static_cast<double>(random() % 100000) / 100000; };
  std::vector<std::uint8_t> set;
  for (int k = 0; k < dims[2]; ++k)
    for (int j = 0; j < dims[1]; ++j)
      for (int i = 0; i < dims[0]; ++i) {
        const Vec3 p = voxel_mm * Vec3(i - 0.5 * dims[0], j - 0.5 * dims[1], k - 0.5 * dims[2]);
        const double along = p.x() / (0.5 * length_mm);  // narrower at the snout
        const Vec3 half(0.5 * length_mm, (0.22 - 0.08 * along) * length_mm, (0.2 - 0.07 * along) * length_mm);
        const double r = p.cwiseQuotient(half).norm();
        const double depth_mm = (1 - r) * p.norm() / std::max(r, 1e-9);
        const bool wall = depth_mm > 0 && depth_mm < 2 * voxel_mm;
        const bool behind = p.x() < 0 && std::hypot(p.y(), p.z()) < 0.1 * length_mm;
        const bool pore = share() < pores;
        set.push_back(wall && !behind && !pore);
      }
  return voxel_faces(set, dims, voxel_mm);
}

}  // namespace

TEST_CASE("of a thin skull riddled with pores comes a template without faults that lies near it") {
  MeshFile skull = thin_skull(0.25);
  CHECK_FALSE(Topology::make(skull.points.rows(), skull.triangles));
  for (const Eigen::Index v : {100, 2000, 5000}) skull.points(v, 2) = std::numeric_limits<double>::quiet_NaN();
  const MeshTemplate made = make_mesh_template(skull, with_vertices(2500)).value();
  CHECK(made.mended.not_finite == 3);
  CHECK(made.mended.non_manifold_edges > 100);
  REQUIRE(made.rebuilt);
  CHECK(made.rebuilt->genus_before > 100);
  CHECK(made.mesh.points.rows() == 2500);
  CHECK(made.mesh.topology->genus() <= 2);
  const MeshFaults faults = mesh_faults(made.mesh);
  INFO(faults.words());
  CHECK_FALSE(faults.any());
  CHECK(made.to_mesh.mean_mm < 0.5);
  const auto said = [&](const std::string& what) {
    return std::any_of(made.warnings.begin(), made.warnings.end(),
                       [&](const std::string& warning) { return warning.find(what) != std::string::npos; });
  };
  CHECK(said("was mended"));
  CHECK(said("was rebuilt from voxels"));
  CHECK((made.from_mesh.mean_mm < 0.5 || said("from the surface on average")));
}

TEST_CASE("a thin skull that is rebuilt keeps its walls") {
  const MeshTemplate made = make_mesh_template(thin_skull(0.12, 20, 0.2), with_vertices(5000)).value();
  REQUIRE(made.rebuilt);
  CHECK(made.from_mesh.max_mm < 1.2);
}

TEST_CASE("few faces of both sides of a thin wall meet where vertices are spread over it, and none in the end") {
  const Mesh skull = largest_part(repaired(thin_skull(0.4, 20, 0)).value().mesh);
  const SurfaceSearch search(skull);
  const auto project = [&](const Vec3& p) { return search.nearest(p).position; };
  std::size_t before = 0;
  for (const int vertices : {5000, 8000}) {
    CAPTURE(vertices);
    before += self_intersections(remesh_to_count(skull, vertices, project)).size();
    const Mesh spread = spread_over(skull, vertices);
    CHECK(self_intersections(spread).empty());
    CHECK(surface_distance(spread, skull).max_mm < 0.4);
  }
  CHECK(before > 0);
}

TEST_CASE("tunnels of a surface are cut to the number that is asked for") {
  const MeshFile ring = surface_file(shapes::torus(36, 18, 20, 8));
  CHECK(make_mesh_template(ring, with_vertices(400)).value().mesh.topology->genus() == 1);
  const MeshTemplate cut = make_mesh_template(ring, with_vertices(400, {GenusRule::Kind::number, 0})).value();
  CHECK(cut.mesh.topology->genus() == 0);
  CHECK(cut.rebuilt);
  CHECK(make_mesh_template(ring, with_vertices(400, {GenusRule::Kind::number, 1})).value().rebuilt == std::nullopt);
  const auto fewer = make_mesh_template(ring, with_vertices(400, {GenusRule::Kind::number, 2}));
  REQUIRE_FALSE(fewer);
  CHECK(fewer.error().what == "has one tunnel, fewer than --genus 2; use --genus keep");
}

TEST_CASE("the wide hole of a thin ring is filled by a disc") {
  const MeshFile ring = surface_file(shapes::torus(48, 16, 30, 6));
  const MeshTemplate cut = make_mesh_template(ring, with_vertices(400, {GenusRule::Kind::number, 0})).value();
  CHECK(cut.mesh.topology->genus() == 0);
  CHECK_FALSE(mesh_faults(cut.mesh).any());
  Box box = bounds_of(cut.mesh.points);
  CHECK(box.sizes().z() < 15);  // and not by a lump
}

TEST_CASE("what is far away does not make a part that is rebuilt coarse") {
  const Mesh ball = icosphere(3, 5);
  Mesh far = icosphere(3, 4.9);
  far.points.rowwise() += Eigen::RowVector3d(1000, 1000, 1000);
  MeshTemplateOptions options = with_vertices(400);
  options.closing_mm = 0.5;
  const MeshTemplate made = make_mesh_template(surface_file(joined({ball, far})), options).value();
  REQUIRE(made.rebuilt);
  CHECK(made.rebuilt->voxel_mm < 0.5);
  CHECK(surface_distance(made.mesh, ball).mean_mm < 0.1);
  const auto one_of_two = [](const std::string& text) { return text.find("2 parts") != std::string::npos; };
  CHECK(std::any_of(made.warnings.begin(), made.warnings.end(), one_of_two));
}

TEST_CASE("the thickness of walls that is reported is that which was made") {
  // Two parts whose boxes meet, so that the voxels are coarse.
  const Mesh plate = shapes::box(Vec3(0, 0, 0.1), Vec3(10, 10, 0.2));
  Mesh long_one = shapes::box(Vec3(5, 5, 0.1), Vec3(4000, 4000, 0.2));
  long_one.points.row(7) += Eigen::RowVector3d(0, 0, 4000);
  const SolidVoxels solid = solid_voxels(joined({plate, long_one}), {.spacing_mm = 0.5, .wall_mm = 2});
  CHECK(solid.label_map.geometry.spacing_mm[0] > 10);
  CHECK(solid.wall_mm == 2 * solid.label_map.geometry.spacing_mm[0]);
}

TEST_CASE("making a solid can be cancelled and a long face takes little work") {
  Progress progress;
  progress.cancel();
  const Mesh ball = icosphere(3, 10);
  const SolidVoxels none = solid_voxels(ball, {.spacing_mm = 0.5, .wall_mm = 2}, &progress);
  const auto& voxels = std::get<std::vector<std::uint8_t>>(none.label_map.data);
  CHECK(std::count(voxels.begin(), voxels.end(), 1) == 0);
  const Mesh beam = shapes::box(Vec3::Zero(), Vec3(20000, 2, 2));
  CHECK(test::cpu_seconds_of([&] { solid_voxels(beam, {.spacing_mm = 1, .wall_mm = 1}); }) < 10);
}

TEST_CASE("a wall thinner than its voxels is kept and a solid stays as it is") {
  const Mesh plate = shapes::box(Vec3(0, 0, 0.41), Vec3(20, 20, 0.45));
  const Volume thin = solid_voxels(plate, {.spacing_mm = 1, .wall_mm = 3}).label_map;
  const auto& voxels = std::get<std::vector<std::uint8_t>>(thin.data);
  const auto count = [](const std::vector<std::uint8_t>& set) { return std::count(set.begin(), set.end(), 1); };
  CHECK(count(voxels) > 2.4 * 20 * 20);
  CHECK(count(voxels) < 4.5 * 23 * 23);
  CHECK(genus_of(voxels, thin.geometry.dims) == 0);
  const Mesh ball = icosphere(3, 10);
  const Volume solid = solid_voxels(ball, {.spacing_mm = 0.5, .wall_mm = 2}).label_map;
  const double inside_ml = static_cast<double>(count(std::get<std::vector<std::uint8_t>>(solid.data))) * 0.125 / 1000;
  CHECK(inside_ml == doctest::Approx(enclosed_volume_ml(ball)).epsilon(0.01));
}

TEST_CASE("a template of a surface is the scaled one of a scaled surface") {
  const MeshFile ring = surface_file(shapes::torus(36, 18, 20, 8));
  MeshFile small = ring;
  small.points /= 16;
  for (const GenusRule& genus : {GenusRule{}, GenusRule{GenusRule::Kind::number, 0}}) {
    const Mesh large = make_mesh_template(ring, with_vertices(300, genus)).value().mesh;
    const Mesh made = make_mesh_template(small, with_vertices(300, genus)).value().mesh;
    REQUIRE(made.topology->hash() == large.topology->hash());
    CHECK(largest_difference(16 * made.points, large.points) < 1e-6 * 56);
  }
}

TEST_CASE("a template from an existing mesh keeps its frame and takes what is broken out") {
  const Mesh ball = icosphere(3, 20);
  MeshFile soup;  // every face with corners of its own, as STL has them, and one face without area
  const Triangles& triangles = ball.topology->triangles();
  soup.points.resize(3 * triangles.rows(), 3);
  Triangles& faces = soup.triangles.edit();
  faces.resize(triangles.rows() + 1, 3);
  for (Eigen::Index f = 0; f < triangles.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      soup.points.row(3 * f + k) = ball.points.row(triangles(f, k)) + Eigen::RowVector3d(100, -50, 7);
      faces(f, k) = static_cast<std::int32_t>(3 * f + k);
    }
  faces.row(triangles.rows()) << 0, 0, 1;
  const auto made = make_mesh_template(soup, with_vertices(900));
  REQUIRE(made);
  CHECK(made->mesh.points.rows() == 900);
  CHECK((made->mesh.points.colwise().mean() - Eigen::RowVector3d(100, -50, 7)).norm() < 0.3);
  CHECK(made->to_mesh.max_mm < 0.5);
  CHECK(made->warnings.size() == 1);

  MeshFile open{ball.points, triangles.topRows(triangles.rows() - 1), {}, 10, {}, {}, {}};
  const auto closed = make_mesh_template(open, with_vertices(600));
  REQUIRE(closed);
  CHECK(closed->mesh.topology->closed());
  CHECK(closed->warnings.size() == 1);
}
