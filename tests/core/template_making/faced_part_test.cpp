#include "core/template_making/faced_part.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "core/adapt/boundary/boundary.h"
#include "core/mesh/parts/rims.h"
#include "tests/must.h"

namespace homolog {

namespace {

constexpr double radius_mm = 25, base_mm = 10;
constexpr int organ = 3, above = 5, around = 7;

/// A ball about the origin, and `above` around it beyond base_mm along the grid's third axis. `gap_mm` of nothing lies
/// between them.
Volume ball_and_neighbour(const VolumeGeometry& grid, double gap_mm, int elsewhere = 0) {
  Volume labels;
  labels.geometry = grid;
  std::vector<std::uint8_t> voxels(grid.voxels());
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i) {
        const Vec3 p = grid.to_mm(Vec3(i, j, k));
        const double r = p.norm(), up = p.dot(grid.direction.col(2));
        const int value = r < radius_mm ? organ : r < radius_mm + gap_mm ? 0 : up > base_mm ? above : elsewhere;
        voxels[grid.index(i, j, k)] = static_cast<std::uint8_t>(value);
      }
  labels.data = std::move(voxels);
  return labels;
}

VolumeGeometry grid_of(const Vec3& spacing_mm, const Mat3& direction) {
  VolumeGeometry grid;
  grid.spacing_mm = spacing_mm;
  grid.direction = direction;
  for (std::size_t axis = 0; axis < 3; ++axis)
    grid.dims[axis] = static_cast<int>(70 / spacing_mm[static_cast<Eigen::Index>(axis)]);
  const Vec3 last(grid.dims[0] - 1, grid.dims[1] - 1, grid.dims[2] - 1);
  grid.origin_mm = -(direction * (spacing_mm.cwiseProduct(last) / 2));
  return grid;
}

Mesh surface_of_organ(const Volume& labels) {
  return test::must(label_boundary(labels, organ, 0, std::nullopt, 2500)).surface;
}

}  // namespace

TEST_CASE("the part of a label's surface that faces another ends where the two part") {
  const Mat3 tilted = Eigen::AngleAxisd(0.6, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (const auto& [spacing_mm, direction, gap_mm] :
       {std::tuple{Vec3(1, 1, 1), Mat3(Mat3::Identity()), 0.0}, std::tuple{Vec3(1, 1, 1), tilted, 1.0},
        std::tuple{Vec3(1.4, 1.4, 4), tilted, 0.0}}) {
    CAPTURE(spacing_mm.transpose());
    CAPTURE(gap_mm);
    const Volume labels = ball_and_neighbour(grid_of(spacing_mm, direction), gap_mm);
    const Mesh whole = surface_of_organ(labels);
    const double near_mm = spacing_mm.maxCoeff() + gap_mm / 2;  // about a voxel
    for (const bool kept : {true, false}) {
      CAPTURE(kept);
      const Mesh part = test::must(faced_part(whole, labels, organ, 0, {{above}, kept}));
      REQUIRE(part.topology->rims().size() == 1);
      const Rim& rim = part.topology->rims().front();
      const VertexScalars up = part.points * direction.col(2);
      double off_mm = 0, farthest_mm = 0;
      for (const std::int32_t i : rim) {
        off_mm += std::abs(up[i] - base_mm) / static_cast<double>(rim.size());
        farthest_mm = std::max(farthest_mm, std::abs(up[i] - base_mm));
        CHECK(part.points.row(i).norm() == doctest::Approx(radius_mm).epsilon(0.04));
      }
      CHECK(off_mm < near_mm);
      CHECK(farthest_mm < 2 * near_mm);
      CHECK((kept ? up.minCoeff() : -up.maxCoeff()) > (kept ? base_mm : -base_mm) - 2 * near_mm);
      CHECK((kept ? up.maxCoeff() : -up.minCoeff()) == doctest::Approx(radius_mm).epsilon(0.05));
    }
  }
}

TEST_CASE("what lies around a label may be named background, and what it does not face is refused") {
  const Volume labels = ball_and_neighbour(grid_of(Vec3(1, 1, 1), Mat3::Identity()), 0);
  const Mesh whole = surface_of_organ(labels);
  const Mesh not_above = test::must(faced_part(whole, labels, organ, 0, {{above}, false}));
  const Mesh outer = test::must(faced_part(whole, labels, organ, 0, {{0}, true}));
  CHECK(outer.points.col(2).maxCoeff() == doctest::Approx(not_above.points.col(2).maxCoeff()).epsilon(0.1));
  CHECK(faced_part(whole, labels, organ, 0, {{9}, true}).error().what ==
        "label 3 faces none of the labels that are named; name its neighbours");
  CHECK(faced_part(whole, labels, organ, 0, {{0, above}, true}).error().what ==
        "label 3 faces the labels that are named and no others; name some of them");
  const Volume two = ball_and_neighbour(grid_of(Vec3(1, 1, 1), Mat3::Identity()), 0, around);
  CHECK(test::must(faced_part(whole, two, organ, 0, {{around}, true})).points.rows() ==
        test::must(faced_part(whole, two, organ, 0, {{above}, false})).points.rows());
}

TEST_CASE("of a part in several pieces the largest is taken, and what is left out is said") {
  Volume labels = ball_and_neighbour(grid_of(Vec3(1, 1, 1), Mat3::Identity()), 0);
  auto& voxels = std::get<std::vector<std::uint8_t>>(labels.data);
  const auto& grid = labels.geometry;
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i)
        if (auto& voxel = voxels[grid.index(i, j, k)]; voxel == 0 && grid.to_mm(Vec3(i, j, k)).z() < -15) voxel = above;
  Mesh part = test::must(faced_part(surface_of_organ(labels), labels, organ, 0, {{above}, true}));
  REQUIRE(part.topology->components() == 2);
  // Caps are as large as they are high: 15 mm above and 10 mm below.
  const auto said = take_largest_piece(part, organ);
  REQUIRE(said);
  CHECK(part.topology->components() == 1);
  CHECK(part.points.col(2).minCoeff() > 0);
  CHECK((*said == "the part of label 3 is in several pieces; the largest was taken, and the others (40 % of its area) "
                  "are left out" ||
         said->find("(39 %") != std::string::npos || said->find("(41 %") != std::string::npos));
  CHECK_FALSE(take_largest_piece(part, organ));
}

TEST_CASE("a template says which part of a surface it is of, and a map without its neighbours is whole") {
  const Volume labels = ball_and_neighbour(grid_of(Vec3(1, 1, 1), Mat3::Identity()), 0);
  const Mesh part = test::must(faced_part(surface_of_organ(labels), labels, organ, 0, {{above}, false}));
  MeshFile file;
  file.points = part.points;
  file.triangles = part.topology;
  file.comments = {faced_comment({"atrium,4", false})};
  const auto the_template = test::must(make_template(file, "ventricle.ply"));
  REQUIRE(the_template->faced);
  CHECK(*the_template->faced == FacedNames{"atrium,4", false});
  CHECK(to_mesh_file(*the_template).comments == file.comments);

  Segmentation known;
  known.add({.name = "Left atrium", .value = 2});
  std::vector<std::string> warnings;
  CHECK_FALSE(parts_for(*the_template, known, warnings).faced);
  REQUIRE(warnings.size() == 1);
  CHECK(warnings.front().find("atrium") != std::string::npos);
  known.add({.name = "atrium", .value = above});
  warnings.clear();
  const LabelParts parts = parts_for(*the_template, known, warnings);
  CHECK(warnings.empty());
  REQUIRE(parts.faced);
  CHECK(parts.faced->values == std::vector{above, 4});
  CHECK(parts.rims == 1);

  const Boundary open = test::must(label_boundary(labels, organ, 0, std::nullopt, 2500, parts));
  CHECK(open.surface.topology->rims().size() == 1);
  CHECK(open.warnings.empty());
  CHECK(open.why_whole.empty());
  const Boundary closed =
      test::must(label_boundary(labels, organ, 0, std::nullopt, 2500, {.faced = FacedLabels{{9}, true}, .rims = 1}));
  CHECK(closed.surface.topology->closed());
  REQUIRE(closed.warnings.size() == 1);
  CHECK(closed.warnings.front() == "label 3 faces none of the labels that are named, and its whole surface was taken");
  CHECK(closed.why_whole == closed.warnings.front());
}

}  // namespace homolog
