#include "core/structures/fitting/keep_apart.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "core/deform/fold_guard.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_quality.h"
#include "core/structures/fitting/set_in_case.h"
#include "tests/must.h"
#include "tests/shapes.h"

namespace homolog {

namespace {

Mesh large_ball_at(double x_mm, double radius_mm = 20) {
  Mesh ball = icosphere(4, radius_mm);
  ball.points.col(0).array() += x_mm;
  return ball;
}

constexpr MeshPair both{0, 1};

}  // namespace

TEST_CASE("a depth is how far a mesh lies within another, and a distance where it does not") {
  CHECK(depth_mm(large_ball_at(0), large_ball_at(37), 10) == doctest::Approx(3).epsilon(0.02));
  CHECK(depth_mm(large_ball_at(0), large_ball_at(44), 10) == doctest::Approx(-4).epsilon(0.02));
  CHECK(depth_mm(large_ball_at(0), large_ball_at(80), 10) == -10);
}

TEST_CASE("what lies before the opening of an open mesh is not within it") {
  const Mesh ball = large_ball_at(0);
  std::vector<std::int32_t> lower;
  for (std::int32_t v = 0; v < ball.points.rows(); ++v)
    if (ball.points(v, 2) <= 1e-9) lower.push_back(v);
  std::vector<Eigen::Vector3i> faces;
  for (std::int32_t f = 0; f < ball.topology->triangles().rows(); ++f) {
    Eigen::Vector3i face;
    bool whole = true;
    for (int c = 0; c < 3; ++c) {
      const auto at = std::ranges::lower_bound(lower, ball.topology->triangles()(f, c));
      whole = whole && at != lower.end() && *at == ball.topology->triangles()(f, c);
      face[c] = static_cast<int>(at - lower.begin());
    }
    if (whole) faces.push_back(face);
  }
  Triangles triangles(std::ssize(faces), 3);
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) triangles.row(f) = faces[static_cast<std::size_t>(f)].transpose();
  const Mesh bowl{test::must(Topology::make(std::ssize(lower), std::move(triangles))), ball.points(lower, Eigen::all)};
  Mesh small = icosphere(2, 3);
  small.points.col(2).array() += 12;
  CHECK(depth_mm(small, bowl, 5) == -5);
  CHECK(depth_mm(small, ball, 5) > 5);
  // In its wall it lies within it as in the whole ball.
  small.points.col(2).array() -= 31;
  CHECK(depth_mm(small, bowl, 5) == doctest::Approx(depth_mm(small, ball, 5)));
}

TEST_CASE("two that lie within each other meet halfway, and what is far from there stays") {
  std::vector<Mesh> balls{large_ball_at(0), large_ball_at(37)};
  const std::vector<Mesh> before = balls;
  const double left_mm = keep_apart(balls, {&both, 1}).front();
  CHECK(left_mm <= 0.1);
  CHECK(depth_mm(balls[0], balls[1], 1) <= 0.1);
  CHECK(depth_mm(balls[1], balls[0], 1) <= 0.1);
  // They met 3 mm deep at x = 18.5 mm.
  CHECK(balls[0].points.col(0).maxCoeff() == doctest::Approx(18.5).epsilon(0.02));
  CHECK(balls[1].points.col(0).minCoeff() == doctest::Approx(18.5).epsilon(0.02));
  for (Eigen::Index v = 0; v < balls[0].points.rows(); ++v)
    if (before[0].points(v, 0) < 0) CHECK(balls[0].points.row(v) == before[0].points.row(v));
  for (const Mesh& ball : balls) CHECK(self_intersections(ball).empty());
}

TEST_CASE("a gap is left where one is asked for") {
  std::vector<Mesh> balls{large_ball_at(0), large_ball_at(40.5)};
  CHECK(keep_apart(balls, {&both, 1}, 2).front() <= 0.1);
  CHECK(depth_mm(balls[0], balls[1], 10) <= -1.9);
}

TEST_CASE("one that yields goes all the way") {
  std::vector<Mesh> balls{large_ball_at(0), large_ball_at(37)};
  const Mesh first = balls[0], ball_at_37 = balls[1];
  CHECK(keep_apart(balls, {&both, 1}, 0, {0, 1}).front() <= 0.1);
  CHECK(balls[0].points == first.points);
  CHECK(depth_mm(balls[1], balls[0], 1) <= 0.1);
  // On the axis the second ball ended at x = 17 mm and the first one ends at 20 mm.
  Eigen::Index on_axis = 0;
  ball_at_37.points.rowwise().norm().minCoeff(&on_axis);
  CHECK(balls[1].points(on_axis, 0) == doctest::Approx(20).epsilon(0.01));
}

TEST_CASE("one that lies ten millimetres deep, which is many edges, comes out without a fold") {
  // The small ball reaches past the middle of the large one's cap.
  std::vector<Mesh> balls{large_ball_at(0), large_ball_at(22, 12)};
  const Mesh first = balls[0];
  REQUIRE(depth_mm(balls[1], balls[0], 1) > 9);
  CHECK(keep_apart(balls, {&both, 1}, 1, {0, 1}).front() <= 0.1);
  CHECK(balls[0].points == first.points);
  CHECK(depth_mm(balls[1], balls[0], 2) <= -0.9);
  CHECK(self_intersections(balls[1]).empty());
  CHECK(turned_triangles(*balls[1].topology, large_ball_at(22, 12).points, balls[1].points).empty());
}

TEST_CASE("a structure of a case goes out of its neighbour and stays in the wall that holds it") {
  const auto ball_at = [](double x_mm, double radius_mm) {
    MeshFile file;
    file.points = icosphere(3, radius_mm).points.rowwise() + Eigen::RowVector3d(x_mm, 0, 0);
    file.triangles = icosphere(3, radius_mm).topology->triangles();
    return test::must(make_template(file, "ball"));
  };
  const auto small = ball_at(0, 10), neighbour = ball_at(17, 10), wall = ball_at(3, 16);
  Document document = new_document({}, nullptr, small);
  const auto add = [&](const char* id, const std::shared_ptr<const Template>& of) {
    Structure more = new_structure(of, Similarity{});
    more.id = id;
    document.structures.push_back(std::make_shared<const Structure>(std::move(more)));
  };
  add("s2", neighbour);
  add("s3", wall);
  const auto& id = document.structures.front()->id;
  const auto edit = apart_from_others(document, id);
  REQUIRE(edit);
  const Mesh moved{small->topology, *edit->points}, other{neighbour->topology, neighbour->points};
  CHECK(depth_mm({small->topology, *document.view()->shape.points}, other, 5) > 2);
  CHECK(depth_mm(moved, other, 5) < 0.1);
  CHECK(moved.points.row(0).norm() < 20);
  const Mesh around{wall->topology, wall->points};
  CHECK(share_within(moved, *ClosedMesh::of(around)) == doctest::Approx(1));
  const auto wider = apart_from_others(document, id, 2);
  REQUIRE(wider);
  CHECK(depth_mm(moved, other, 5) > -0.5);
  CHECK(depth_mm({small->topology, *wider->points}, other, 5) < -1.8);
  document.structures.erase(document.structures.begin() + 1);
  CHECK_FALSE(apart_from_others(document, id));
}

TEST_CASE("a structure with a rim neither goes out of another nor makes one go") {
  const auto template_of = [](const Mesh& mesh) {
    MeshFile file;
    file.points = mesh.points;
    file.triangles = mesh.topology->triangles();
    return test::must(make_template(file, "organ"));
  };
  const auto tube = template_of(shapes::open_cylinder(9, 24, 10, 40)), ball = template_of(icosphere(3, 15));
  Document document = new_document({}, nullptr, tube);
  Structure more = new_structure(ball, Similarity{});
  more.id = "s2";
  document.structures.push_back(std::make_shared<const Structure>(std::move(more)));
  CHECK(depth_mm({ball->topology, ball->points}, {tube->topology, tube->points}, 5) > 2);  // they meet
  CHECK_FALSE(apart_from_others(document, document.structures.front()->id));
  CHECK_FALSE(apart_from_others(document, "s2"));
}

TEST_CASE("a thin plate that has no room between two balls does not fold and what is left of the gap is told") {
  Mesh plate = icosphere(4, 15);
  plate.points.col(0) *= 0.1;
  std::vector<Mesh> meshes{large_ball_at(-21.5), plate, large_ball_at(21.5)};
  const std::vector<MeshPair> pairs{{0, 1}, {1, 2}, {0, 2}};
  const auto left_mm = keep_apart(meshes, pairs, 4, {0, 1, 0});
  for (const Mesh& mesh : meshes) CHECK(self_intersections(mesh).empty());
  CHECK(turned_triangles(*plate.topology, plate.points, meshes[1].points).empty());
  // Of the 4 mm a part is left, as far as the meshes say themselves.
  for (const std::size_t p : {0U, 1U}) {
    CHECK(left_mm[p] > 0.5);
    CHECK(left_mm[p] < 4.1);
    const double mm = std::max(depth_mm(meshes[pairs[p][0]], meshes[pairs[p][1]], 10),
                               depth_mm(meshes[pairs[p][1]], meshes[pairs[p][0]], 10));
    CHECK(mm == doctest::Approx(left_mm[p] - 4).epsilon(0.02));
  }
  CHECK(left_mm[2] == 0);
}

TEST_CASE("three in a row come apart, and those that touch nobody stay") {
  std::vector<Mesh> balls{large_ball_at(0), large_ball_at(38), large_ball_at(76), large_ball_at(200)};
  const std::vector<MeshPair> pairs{{0, 1}, {0, 2}, {1, 2}, {2, 3}};
  for (const double left_mm : keep_apart(balls, pairs)) CHECK(left_mm <= 0.1);
  CHECK(depth_mm(balls[0], balls[1], 1) <= 0.1);
  CHECK(depth_mm(balls[2], balls[1], 1) <= 0.1);
  CHECK(balls[3].points == large_ball_at(200).points);
}

}  // namespace homolog
