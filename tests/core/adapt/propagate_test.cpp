#include "core/adapt/propagate.h"

#include "core/mesh/mesh_quality.h"
#include "tests/beating_ball.h"

// Which frame takes how much from which other one.

namespace homolog {

namespace {

Mesh first_ball() {
  return icosphere(2, BeatingBall::radius_mm(0));
}

/// The beating ball with nothing but grain in these frames.
Volume without_frames(const std::vector<int>& frames) {
  Volume cine = BeatingBall::cine();
  auto& voxels = std::get<std::vector<float>>(cine.data);
  const std::size_t count = cine.geometry.voxels();
  for (const int frame : frames)
    for (std::size_t v = 0; v < count; ++v)
      voxels[static_cast<std::size_t>(frame) * count + v] = static_cast<float>(v * 7919 % 101);
  return cine;
}

Propagation carried(const Volume& cine, const PropagateOptions& options = {}) {
  const Mesh ball = first_ball();
  return test::must(propagate(cine, 0, ball, VertexScalars::Ones(ball.points.rows()), options));
}

double radius_of(const Points& points) {
  return points.rowwise().norm().mean();
}

}  // namespace

TEST_CASE("what is ejected is the share of the largest volume and frames are found by number") {
  const auto found = ejection_of({{0, 90}, {2, 100}, {3, 55}, {5, 40}, {7, 80}});
  REQUIRE(found);
  CHECK(found->end_diastole == 2);
  CHECK(found->end_systole == 5);
  CHECK(found->fraction == doctest::Approx(0.6));
  CHECK(ejection_of({{4, 50}})->fraction == 0);
  CHECK_FALSE(ejection_of({}));
}

TEST_CASE("a frame follows the known one that is nearer") {
  // In frame 3 a person drew the ball 2 mm too large: what is learned there is taken along.
  PropagateOptions options;
  const Mesh ball = first_ball();
  options.known[3] = (BeatingBall::radius_mm(3) + 2) / BeatingBall::radius_mm(0) * ball.points;
  const Propagation done = carried(BeatingBall::cine(), options);
  const auto larger = [&](std::size_t f) {
    return radius_of(done.frames[f].points) - BeatingBall::radius_mm(static_cast<int>(f));
  };
  CHECK(larger(0) == doctest::Approx(0).scale(1));
  CHECK(larger(1) > 0.2);
  CHECK(larger(2) > larger(1) + 0.2);
  CHECK(larger(4) > larger(5) + 0.2);
  CHECK(larger(2) < 2);
}

TEST_CASE("frames that show nothing lie between their neighbours by how near those are") {
  const Propagation done = carried(without_frames({2, 3}));
  const auto points = [&](std::size_t f) -> const Points& { return done.frames[f].points; };
  for (const std::size_t f : {2u, 3u}) {
    CHECK(done.frames[f].doubt.find("does not show the boundary") != std::string::npos);
    CHECK(done.frames[f].confidence == 0);
  }
  CHECK((points(2) - (2 * points(1) + points(4)) / 3).cwiseAbs().maxCoeff() < 1e-9);
  CHECK((points(3) - (points(1) + 2 * points(4)) / 3).cwiseAbs().maxCoeff() < 1e-9);
  CHECK(done.frames[1].doubt.empty());
  // What is in doubt is neither the largest nor the smallest.
  CHECK(done.ejection.end_diastole == 0);
  CHECK((done.ejection.end_systole == 1 || done.ejection.end_systole == 4 || done.ejection.end_systole == 5));
  CHECK(done.frames[1].volume_ml == doctest::Approx(enclosed_volume_ml({first_ball().topology, points(1)})));
}

TEST_CASE("a frame that shows less than the others is in doubt and the others are not") {
  Volume cine = BeatingBall::cine();
  auto& voxels = std::get<std::vector<float>>(cine.data);
  const std::size_t count = cine.geometry.voxels();
  // A third of the contrast: likely enough to be followed, and not to be believed.
  for (std::size_t v = 4 * count; v < 5 * count; ++v) voxels[v] = 40 + 0.3f * voxels[v];
  const Propagation done = carried(cine);
  for (const std::size_t f : {0u, 1u, 2u, 3u, 5u}) CHECK(done.frames[f].doubt.empty());
  CHECK(done.frames[4].doubt == "shows less of the boundary than other frames");
  CHECK(done.frames[4].confidence > 0.35);
  CHECK(done.frames[4].confidence < 0.7);
}

}  // namespace homolog
