#include "app/editor/state/figures/findings.h"

#include "app/editor/state/figures/quality.h"
#include "app/editor/state/views.h"
#include "app/editor/work/opening/demo.h"
#include "app/editor/work/shape_monitor.h"
#include "core/measure/compare.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_quality.h"
#include "tests/ball.h"
#include "tests/desk.h"

namespace homolog {

TEST_CASE("a wall that is pushed through the opposite one is one finding and a click goes to its middle") {
  Mesh ball = icosphere(3, 20);
  std::int32_t pole = 0;
  for (std::int32_t v = 0; v < ball.points.rows(); ++v)
    if (ball.points(v, 2) > ball.points(pole, 2)) pole = v;
  ball.points(pole, 2) = -30;
  std::vector<FacePair> pairs = self_intersections(ball);
  REQUIRE(!pairs.empty());
  const auto found = findings_of(FindingKind::intersecting, ball, pairs);
  REQUIRE(found.size() == 1);
  CHECK(found.front().count > 3);
  CHECK((ball.points.row(found.front().vertex).head<2>()).norm() < 10);
}

TEST_CASE("findings apart are told apart and the thinnest triangle comes first") {
  Mesh ball = icosphere(3, 20);
  const auto neighbour_of = [&](std::int32_t v) { return ball.topology->one_ring(v).front(); };
  const std::int32_t near = 0, far = static_cast<std::int32_t>(ball.points.rows() - 1);
  const auto squeeze = [&](std::int32_t v, double share) {
    const std::int32_t to = neighbour_of(v);
    ball.points.row(v) += share * (ball.points.row(to) - ball.points.row(v));
  };
  squeeze(near, 0.9);
  squeeze(far, 0.98);
  std::vector<FacePair> thin;
  for (std::int32_t face = 0; face < ball.topology->triangles().rows(); ++face)
    if (smallest_angle_deg(ball, face) < thin_below_deg) thin.push_back({face, face});
  const auto found = findings_of(FindingKind::thin, ball, thin);
  REQUIRE(found.size() == 2);
  CHECK((ball.points.row(found[0].vertex) - ball.points.row(far)).norm() < 5);
  CHECK((ball.points.row(found[1].vertex) - ball.points.row(near)).norm() < 5);
}

TEST_CASE("the figures of a first structure that is gone are forgotten") {
  ShapeMonitor<Eigen::Index> monitor(
      [] {}, "The vertices",
      [](const Document& document, const std::string& of) { return document.view(of)->shape.points->rows(); });
  Document document = ball_document(20, 1);
  Structure second = *ball_document(20, 2).structure();
  second.id = "s2";
  document.structures.push_back(std::make_shared<const Structure>(std::move(second)));
  monitor.post(std::make_shared<const Document>(document));
  monitor.finish();
  REQUIRE(monitor.latest());
  CHECK(*monitor.latest() == 42);
  monitor.post(std::make_shared<const Document>(document));  // of the same structure they stay until there are new ones
  CHECK(monitor.latest());
  document.structures.erase(document.structures.begin());
  monitor.post(std::make_shared<const Document>(document));
  CHECK_FALSE(monitor.latest());
  monitor.finish();
  REQUIRE(monitor.latest());
  CHECK(*monitor.latest() == 162);
}

TEST_CASE("vertices without a clear edge are grouped and large groups come first") {
  const Mesh ball = icosphere(3, 20);
  VertexScalars confidence = VertexScalars::Ones(ball.points.rows());
  confidence[0] = 0;
  for (Eigen::Index v = 0; v < ball.points.rows(); ++v)
    if (ball.points(v, 2) < -15) confidence[v] = 0.1;
  const auto found = unclear_edges(ball, confidence);
  REQUIRE(found.size() == 2);
  CHECK(found[0].count > found[1].count);
  CHECK(ball.points(found[0].vertex, 2) < -15);
  CHECK(found[1].vertex == 0);
}

TEST_CASE("five pulls along the guide's arrows bring the first case to its boundary") {
  FirstCase first = test::must(first_case());
  REQUIRE(first.guide.steps.size() == 5);
  const Mesh truth{first.document.structure()->the_template->topology, phantom_truth(Organ::kidney, 1).front().points};
  EditSession session(first.document);
  const double before_mm = surface_distance(session.document().view()->mesh(), truth).mean_mm;
  const double sigma_mm = default_sigmas_mm(*session.document().view()->shape.reference).back();
  for (const GuideStep& step : first.guide.steps) {
    CHECK(step.far_mm > 3);  // to be seen
    const Vec3 at = pulled_from(step, session.document().view()->mesh());
    test::must(session.apply(Stroke{Tool::pull, at, step.to_mm, sigma_mm}));
    CHECK(is_done(step, session.document().view()->mesh()));
  }
  const double after_mm = surface_distance(session.document().view()->mesh(), truth).mean_mm;
  CAPTURE(after_mm);
  CHECK(after_mm < 0.5 * before_mm);
}

TEST_CASE("looking closely brings all views to the place") {
  Desk desk;
  const Mesh mesh = desk.document.view()->mesh();
  look_closely(desk.state, mesh, 7);
  const Vec3 at = mesh.points.row(7);
  CHECK(desk.state.look.crosshair_mm == at);
  CHECK(desk.state.look.camera.target == at);
  for (const SlicePan& pan : desk.state.look.slices) CHECK(pan.centre_mm == at);
}

}  // namespace homolog
