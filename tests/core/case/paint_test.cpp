#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "core/case/action_json.h"
#include "core/mesh/geometry/curvature.h"
#include "core/session/session.h"
#include "tests/ball.h"
#include "tests/refusal.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

const Region capsule{"capsule", 5, {224, 164, 88}}, hilum{"hilum", 1, {96, 165, 214}};

EditSession ball_session() {
  return EditSession(ball_document(20));
}

int vertices_in(const Document& document, std::uint8_t number) {
  return static_cast<int>(std::count(document.structure()->paint.regions->of_vertex.begin(),
                                     document.structure()->paint.regions->of_vertex.end(), number));
}

}  // namespace

TEST_CASE("a region gives its factor to what is painted and keeps it when its factor changes") {
  EditSession session = ball_session();
  REQUIRE(session.apply(SetRegion{capsule}));
  REQUIRE(session.apply(SetRegion{hilum}));
  REQUIRE(session.apply(PaintRegion{"capsule", {0, 0, 20}, 15, 0}));
  const Document painted = session.document();
  const int touched = vertices_in(painted, 1);
  CHECK(touched > 20);
  for (Eigen::Index i = 0; i < painted.structure()->paint.stiffness->size(); ++i)
    CHECK((*painted.structure()->paint.stiffness)[i] ==
          (painted.structure()->paint.regions->of_vertex[static_cast<std::size_t>(i)] == 1 ? 5 : 1));
  REQUIRE(session.apply(SetRegion{{"capsule", 8, {1, 2, 3}}}));
  CHECK(session.document().structure()->paint.stiffness->maxCoeff() == doctest::Approx(8));
  CHECK(session.document().structure()->paint.regions->list[0].colour == std::array<std::uint8_t, 3>{1, 2, 3});
  REQUIRE(session.apply(Undo{}));
  CHECK(*session.document().structure()->paint.stiffness == *painted.structure()->paint.stiffness);
  REQUIRE(session.apply(PaintRegion{"", {0, 0, 20}, 15, 0}));
  CHECK(vertices_in(session.document(), 1) == 0);
  CHECK(session.document().structure()->paint.stiffness->maxCoeff() == 1);
  CHECK_FALSE(session.apply(PaintRegion{"cortex", {0, 0, 20}, 15, 0}));
  CHECK_FALSE(session.apply(PaintRegion{"capsule", {0, 0, 20}, -1, 0}));
  CHECK_FALSE(session.apply(SetRegion{{"", 2, {}}}));
  CHECK_FALSE(session.apply(SetRegion{{"x", 0, {}}}));
}

TEST_CASE("removing a region leaves the stiffness and renumbers those behind it") {
  EditSession session = ball_session();
  for (const Region& region : {capsule, hilum}) REQUIRE(session.apply(SetRegion{region}));
  REQUIRE(session.apply(PaintRegion{"capsule", {0, 0, 20}, 12, 0}));
  REQUIRE(session.apply(PaintRegion{"hilum", {0, 0, -20}, 12, 0}));
  const int in_hilum = vertices_in(session.document(), 2);
  const auto in_capsule = session.document().structure()->paint.regions->of_vertex;
  CHECK_FALSE(session.apply(RenameRegion{"capsule", "hilum"}));
  CHECK_FALSE(session.apply(RenameRegion{"cortex", "shell"}));
  CHECK_FALSE(session.apply(RenameRegion{"capsule", ""}));
  REQUIRE(session.apply(RenameRegion{"capsule", "shell"}));
  CHECK(session.document().structure()->paint.regions->of_vertex == in_capsule);
  REQUIRE(session.apply(PaintRegion{"shell", {20, 0, 0}, 12, 0}));
  CHECK(vertices_in(session.document(), 1) > static_cast<int>(std::count(in_capsule.begin(), in_capsule.end(), 1)));
  REQUIRE(session.apply(Undo{}));
  REQUIRE(session.apply(RenameRegion{"shell", "capsule"}));
  const auto stiffness = session.document().structure()->paint.stiffness;
  REQUIRE(session.apply(SetRegion{{"capsule", capsule.factor, {9, 9, 9}}}));
  CHECK(session.document().structure()->paint.stiffness == stiffness);  // another colour is no work for the solver
  REQUIRE(session.apply(RemoveRegion{"capsule"}));
  CHECK(vertices_in(session.document(), 1) == in_hilum);
  CHECK(session.document().structure()->paint.stiffness->maxCoeff() == 5);
  CHECK_FALSE(session.apply(RemoveRegion{"capsule"}));
  REQUIRE(session.apply(RemoveRegion{"hilum"}));
  CHECK(session.document().structure()->paint.regions->of_vertex.empty());
}

TEST_CASE("fill spreads over a connected region and by curvature stops where the surface bends otherwise") {
  EditSession session = ball_session();
  for (const Region& region : {capsule, hilum}) REQUIRE(session.apply(SetRegion{region}));
  REQUIRE(session.apply(PaintRegion{"hilum", {0, 0, 20}, 12, 0}));
  const int cap = vertices_in(session.document(), 2);
  REQUIRE(session.apply(FillRegion{"capsule", {0, 0, -20}, FillRegion::By::region}));
  CHECK(vertices_in(session.document(), 1) == session.document().structure()->paint.stiffness->size() - cap);
  CHECK(vertices_in(session.document(), 2) == cap);

  // A capped cylinder: its flat lid has no curvature, its side has 1/(2r).
  Mesh can = icosphere(4, 20);
  for (Eigen::Index i = 0; i < can.points.rows(); ++i) {
    Vec3 p = can.points.row(i);
    p.z() = std::clamp(p.z(), -10.0, 10.0);
    can.points.row(i) = p;
  }
  MeshFile file;
  file.points = can.points;
  file.triangles = can.topology->triangles();
  EditSession flat(new_document("", nullptr, make_template(file, "can").value()));
  REQUIRE(flat.apply(SetRegion{hilum}));
  REQUIRE(flat.apply(FillRegion{"hilum", {0, 0, 10}, FillRegion::By::curvature, 0.02}));
  const Document& filled = flat.document();
  CHECK(vertices_in(filled, 1) > 50);
  for (Eigen::Index i = 0; i < can.points.rows(); ++i)
    if (filled.structure()->paint.regions->of_vertex[static_cast<std::size_t>(i)] == 1) CHECK(can.points(i, 2) == 10);
}

TEST_CASE("mean curvature of a ball is one over its radius and negative inside out") {
  Mesh ball = icosphere(4, 10);
  const VertexScalars curvature = mean_curvature(ball);
  CHECK(curvature.mean() == doctest::Approx(0.1).epsilon(0.02));
  Triangles turned = ball.topology->triangles();
  turned.col(1).swap(turned.col(2));
  ball.topology = Topology::make(ball.points.rows(), turned).value();
  CHECK((mean_curvature(ball) + curvature).cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("every brush needs a place and a radius that are numbers") {
  constexpr double endless = std::numeric_limits<double>::infinity();
  EditSession session = ball_session();
  REQUIRE(session.apply(SetRegion{capsule}));
  for (const double radius_mm : {0.0, -1.0, endless, std::nan("")}) {
    CAPTURE(radius_mm);
    const Vec3 at(0, 0, 20);
    for (const Action& action :
         {Action(PaintRegion{"capsule", at, radius_mm, 0}), Action(Confirm{at, radius_mm, true}),
          Action(PaintStiffness{at, radius_mm, 5, 0}), Action(SmoothStiffness{at, radius_mm, 1})})
      CHECK(says(session.apply(action), "a radius above 0 mm"));
  }
  CHECK(says(session.apply(Confirm{{0, 0, endless}, 5, true}), "needs a place"));
}

TEST_CASE("a soft brush sets the value within and blends it over its outer share") {
  EditSession session = ball_session();
  const double base = session.document().structure()->paint.base, radius_mm = 16, soft = 0.5;
  REQUIRE(session.apply(PaintStiffness{{0, 0, 20}, radius_mm, 9 * base, soft}));
  const Points& points = *session.document().view()->shape.points;
  int within = 0, between = 0;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const double share = (points.row(i).transpose() - Vec3(0, 0, 20)).norm() / radius_mm;
    const double edge = std::clamp((1 - share) / soft, 0.0, 1.0);
    // The blend rises without a corner: half at the middle of the edge.
    CHECK((*session.document().structure()->paint.stiffness)[i] ==
          doctest::Approx(1 + 8 * edge * edge * (3 - 2 * edge)));
    within += share < 1 - soft ? 1 : 0;
    between += share > 1 - soft && share < 1 ? 1 : 0;
  }
  CHECK(within > 5);
  CHECK(between > 20);
}

TEST_CASE("smoothing goes its share of the way to the mean of the neighbours") {
  EditSession session = ball_session();
  const Document before = session.document();
  VertexScalars factors = VertexScalars::Ones(before.structure()->paint.stiffness->size());
  const Eigen::Index top = 0;
  factors[top] = 7;
  REQUIRE(session.apply(SetStiffnessFactors{std::make_shared<const VertexScalars>(factors)}));
  const Vec3 at = before.view()->shape.points->row(top);
  REQUIRE(session.apply(SmoothStiffness{at, 12, 0.25}));
  CHECK((*session.document().structure()->paint.stiffness)[top] == doctest::Approx(7 - 0.25 * 6));
}

TEST_CASE("smoothing draws factors together and keeps uniform ones") {
  EditSession session = ball_session();
  REQUIRE(session.apply(SmoothStiffness{{0, 0, 20}, 15, 1}));
  CHECK((session.document().structure()->paint.stiffness->array() - 1).abs().maxCoeff() < 1e-12);
  REQUIRE(session.apply(PaintStiffness{{0, 0, 20}, 8, 50, 0}));
  const double before = session.document().structure()->paint.stiffness->maxCoeff();
  REQUIRE(session.apply(SmoothStiffness{{0, 0, 20}, 15, 1}));
  const VertexScalars& after = *session.document().structure()->paint.stiffness;
  CHECK(after.maxCoeff() <= before);
  CHECK(((after.array() > 1.01) && (after.array() < before - 0.01)).count() > 5);
}

TEST_CASE("a stiffness array must fit the mesh and be positive") {
  EditSession session = ball_session();
  const auto with = [&](Eigen::Index n, double value) {
    return session.apply(SetStiffnessFactors{std::make_shared<const VertexScalars>(VertexScalars::Constant(n, value))});
  };
  const Eigen::Index n = session.document().structure()->paint.stiffness->size();
  CHECK(with(n, 3));
  CHECK(session.document().structure()->paint.stiffness->minCoeff() == 3);
  CHECK_FALSE(with(n - 1, 3));
  CHECK_FALSE(with(n, 0));
}

TEST_CASE("a template landmark is a point of the surface that follows the mesh") {
  EditSession session = ball_session();
  REQUIRE(session.apply(SetPlacement{Similarity{Eigen::Quaterniond::Identity(), 2, {5, 6, 7}}}));
  REQUIRE(session.apply(SetTemplateLandmark{"top", Vec3(5.7, 6.3, 60)}));
  const Document& document = session.document();
  REQUIRE(document.structure()->the_template->landmarks.size() == 1);
  const Vec3 position = document.structure()->the_template->landmarks[0].position;
  CHECK(position.norm() == doctest::Approx(20).epsilon(0.03));
  CHECK(position.z() > 19);
  const SurfacePoint on = document.structure()->the_template->landmark_points[0];
  const Vec3 carried =
      on.interpolate(*document.structure()->the_template->topology, *document.view()->shape.points).transpose();
  CHECK((carried - document.view()->shape.placement.apply(position)).norm() < 1e-9);
  REQUIRE(session.apply(SetTemplateLandmark{"top", std::nullopt}));
  CHECK(session.document().structure()->the_template->landmarks.empty());
  CHECK_FALSE(session.apply(SetTemplateLandmark{"top", std::nullopt}));
  REQUIRE(session.apply(Undo{}));
  CHECK(session.document().structure()->the_template->landmarks.size() == 1);
}

TEST_CASE("every painting action reads back from its line") {
  const auto factors = std::make_shared<const VertexScalars>(VertexScalars::LinSpaced(5, 0.1, 3));
  const Action actions[] = {SmoothStiffness{{1, 2, 3}, 4, 0.25},
                            PaintRegion{"capsule", {1, 2, 3}, 4, 0.5},
                            FillRegion{"hilum", {1, 2, 3}, FillRegion::By::curvature, 0.125},
                            SetRegion{capsule},
                            RenameRegion{"hilum", "renal sinus"},
                            RemoveRegion{"hilum"},
                            SetStiffnessFactors{factors},
                            SetTemplateLandmark{"pole", Vec3(1, 2, 3)},
                            SetTemplateLandmark{"pole", std::nullopt}};
  for (const Action& action : actions) {
    const auto back = action_from_json(nlohmann::ordered_json::parse(to_json(action).dump()));
    REQUIRE(back);
    CHECK(*back == action);
  }
  CHECK_FALSE(action_from_json(nlohmann::ordered_json::parse(R"({"region":{"name":"a","factor":1,"colour":"red"}})")));
}

TEST_CASE("a template file keeps stiffness and regions and landmarks and other arrays are offered") {
  EditSession session = ball_session();
  for (const Region& region : {capsule, hilum}) REQUIRE(session.apply(SetRegion{region}));
  REQUIRE(session.apply(PaintRegion{"hilum", {0, 0, 20}, 12, 0.5}));
  REQUIRE(session.apply(SetTemplateLandmark{"upper pole", Vec3(0, 0, 20)}));
  const auto path = std::filesystem::temp_directory_path() / "homolog_paint_test.ply";
  REQUIRE(write_mesh_file(painted_template(*session.document().structure()), path));
  const auto back = read_mesh_file(path);
  REQUIRE(back);
  CHECK(back->regions == *session.document().structure()->paint.regions);
  CHECK((*back->stiffness - *session.document().structure()->paint.stiffness).cwiseAbs().maxCoeff() < 1e-6);
  CHECK(back->landmarks == session.document().structure()->the_template->landmarks);
  CHECK(back->arrays.empty());
  const auto again = make_template(*back, "again");
  REQUIRE(again);
  CHECK(*new_document("", nullptr, *again).structure()->paint.regions ==
        *session.document().structure()->paint.regions);
  std::filesystem::remove(path);
}
