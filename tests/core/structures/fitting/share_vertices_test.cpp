#include "core/structures/fitting/share_vertices.h"

#include <doctest/doctest.h>

#include "core/base/files/files.h"
#include "core/mesh/mesh_quality.h"
#include "core/structures/fitting/fit_set.h"
#include "core/structures/maps/set_map.h"
#include "tests/half_balls.h"
#include "tests/must.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace homolog {

namespace {

using shapes::disc_vertices;
using shapes::half_ball;

/// Two half-balls as a set, "upper" and "lower", which share their disc.
SetOfTemplates halves(int rings, int sectors) {
  SetOfTemplates set;
  for (const bool above : {true, false}) {
    TemplateOfSet one;
    one.name = above ? "upper" : "lower";
    one.value = above ? 1 : 2;
    set.set.structures.push_back(one);
    const Mesh half = half_ball(20, above, rings, sectors);
    MeshFile file;
    file.points = half.points;
    file.triangles = half.topology->triangles();
    set.templates.push_back(test::must(make_template(file, one.name)));
  }
  set.set.shared = {{"upper", "lower", coinciding_vertices(set.templates[0]->points, set.templates[1]->points, 0.5)}};
  return set;
}

}  // namespace

TEST_CASE("coinciding vertices are the nearest of each other and no farther than asked for") {
  for (const auto& [rings, sectors] : {std::pair(4, 12), std::pair(8, 24), std::pair(12, 40)}) {
    CAPTURE(rings);
    const Mesh upper = half_ball(20, true, rings, sectors);
    Mesh lower = half_ball(20, false, rings, sectors);
    REQUIRE(upper.topology->closed());
    CHECK(enclosed_volume_ml(upper) > 0);
    CHECK(enclosed_volume_ml(lower) > 0);
    lower.points.col(2).array() += 0.1;
    CHECK(coinciding_vertices(upper.points, lower.points, 0.05).empty());
    const auto pairs = coinciding_vertices(upper.points, lower.points, 0.11);
    REQUIRE(pairs.size() == static_cast<std::size_t>(disc_vertices(rings, sectors)));
    for (const auto& [a, b] : pairs) CHECK(a == b);
  }
  // Two of one that are as near: the first.
  Points one(1, 3), two(2, 3);
  one << 0, 0, 0;
  two << 1, 0, 0, -1, 0, 0;
  CHECK(coinciding_vertices(one, two, 2) == std::vector<VertexPair>{{0, 0}});
  CHECK(coinciding_vertices(two, one, 2) == std::vector<VertexPair>{{0, 0}});
}

TEST_CASE("what is shared comes to the mean and only what is near goes along") {
  std::vector<Mesh> meshes{half_ball(20, true), half_ball(20, false), half_ball(20, false)};
  const Points before = meshes[0].points;
  const auto disc = coinciding_vertices(meshes[0].points, meshes[1].points, 0.5);
  meshes[1].points.col(2).array() += 0.6;
  meshes[2].points.col(2).array() -= 0.9;
  const std::vector<std::string> names{"a", "b", "c"};
  join_shared({{"a", "b", disc}, {"b", "c", disc}, {"a", "gone", disc}}, names, meshes);
  for (const auto& [a, b] : disc) {
    CHECK(meshes[0].points.row(a) == meshes[1].points.row(b));
    CHECK(meshes[0].points.row(a) == meshes[2].points.row(b));
    CHECK(meshes[0].points(a, 2) == doctest::Approx(-0.1));  // the mean of 0, 0.6 and −0.9
  }
  CHECK(meshes[0].points.row(disc_vertices()) == before.row(disc_vertices()));  // the top of the dome
  CHECK((meshes[0].points - before).cwiseAbs().maxCoeff() == doctest::Approx(0.1));
}

TEST_CASE("what is shared follows the first mesh that leads, and what lies at one place stays") {
  const Mesh upper = half_ball(20, true), lower = half_ball(20, false);
  const auto disc = coinciding_vertices(upper.points, lower.points, 0.5);
  const std::vector<std::string> names{"a", "b", "c"};
  const std::vector<SharedVertices> shared{{"a", "b", disc}, {"c", "b", disc}};
  std::vector<Mesh> meshes{upper, lower, lower};
  follow_shared(shared, names, meshes, std::vector<std::size_t>{0});
  CHECK(meshes[1].points == lower.points);
  const Eigen::RowVector3d moved(0.1, 0.2, 1.3);
  meshes[0].points.row(0) = moved;
  follow_shared(shared, names, meshes, std::vector<std::size_t>{0});
  for (const Mesh& mesh : meshes) {
    CHECK(mesh.points.row(0) == meshes[0].points.row(0));
    CHECK((mesh.points.row(0) - moved).norm() < 2e-5);
    CHECK(mesh.points.middleRows(1, disc_vertices() - 1) == lower.points.middleRows(1, disc_vertices() - 1));
  }
  // The last leads, and then the first: what neither has stays.
  meshes = {upper, lower, lower};
  meshes[0].points.row(0) = moved;
  meshes[2].points.row(0) = -moved;
  follow_shared(shared, names, meshes, std::vector<std::size_t>{2, 0});
  for (const Mesh& mesh : meshes) CHECK((mesh.points.row(0) + moved).norm() < 2e-5);
  // Around a disc that moved the dome goes along, less with every ring.
  meshes = {upper, lower, lower};
  meshes[0].points.topRows(disc_vertices()).col(2).array() -= 2;
  follow_shared(shared, names, meshes, std::vector<std::size_t>{0});
  CHECK((meshes[1].points - meshes[0].points).topRows(disc_vertices()).isZero(0));
  const Points by = meshes[1].points - lower.points;
  CHECK(by(disc_vertices(), 2) == 0);  // the top
  const Eigen::Index next = lower.points.rows() - 24, further = next - 24;
  CHECK(by(next, 2) < -0.5);
  CHECK(by(further, 2) < 0);
  CHECK(by(further, 2) > by(next, 2));
}

TEST_CASE("after a fit two halves of a ball have their disc in common") {
  for (const auto& [rings, sectors] : {std::pair(8, 24), std::pair(12, 40)}) {
    CAPTURE(rings);
    const SetOfTemplates set = halves(rings, sectors);
    REQUIRE(set.set.shared[0].vertices.size() == static_cast<std::size_t>(disc_vertices(rings, sectors)));
    VolumeGeometry grid;
    grid.dims = {60, 60, 60};
    grid.origin_mm.setConstant(-29.3);
    std::vector<MeshOfSegment> meshes;
    for (const bool above : {true, false})
      meshes.push_back({{.name = above ? "upper" : "lower", .value = above ? 1 : 2}, half_ball(22, above)});
    const SetInMap subject = find_in_map(set.set, map_of_meshes(meshes, grid).map);
    const FittedSet fitted = test::must(fit_set(set, subject));
    REQUIRE(fitted.structures[0].fit);
    REQUIRE(fitted.structures[1].fit);
    const Points &upper = fitted.structures[0].fit->mesh.points, &lower = fitted.structures[1].fit->mesh.points;
    for (const auto& [a, b] : set.set.shared[0].vertices) CHECK((upper.row(a) - lower.row(b)).norm() < 1e-6);
    // The disc lies where the halves meet, and the domes are where they were.
    double farthest_mm = 0;
    for (const auto& [a, b] : set.set.shared[0].vertices) farthest_mm = std::max(farthest_mm, std::abs(upper(a, 2)));
    MESSAGE("the disc lies within ", farthest_mm, " mm of z = 0");
    CHECK(farthest_mm < 0.6);
    CHECK(upper.col(2).maxCoeff() == doctest::Approx(22).epsilon(0.03));
    CHECK(lower.col(2).minCoeff() == doctest::Approx(-22).epsilon(0.03));
  }
}

TEST_CASE("shared vertices read back as they were written and what cannot be read is refused") {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path / "a.set.json";
  TemplateSet set = halves(4, 12).set;
  for (TemplateOfSet& one : set.structures) one.file = "built-in:kidney";
  REQUIRE(write_template_set(set, path));
  const TemplateSet read = test::must(read_template_set(path));
  REQUIRE(read.shared.size() == 1);
  CHECK(read.shared[0].a == "upper");
  CHECK(read.shared[0].vertices == set.shared[0].vertices);
  TemplateSet renamed = read;
  REQUIRE(rename_structure(renamed, "Lower", "bottom"));
  CHECK(renamed.shared[0].b == "bottom");
  for (const char* shared : {"3", R"([{"structures":["upper"],"vertices":"1:2"}])",
                             R"([{"structures":["upper","lower"],"vertices":"1:2 3"}])",
                             R"([{"structures":["upper","lower"],"vertices":"1:-2"}])"}) {
    CAPTURE(shared);
    REQUIRE(
        write_whole_file(path, std::string(R"({"homolog_set":1,"structures":[{"name":"upper","template":"a.ply"}],)") +
                                   "\"shared\":" + shared + "}"));
    CHECK(says(read_template_set(path), "declare them anew"));
  }
}

}  // namespace homolog
