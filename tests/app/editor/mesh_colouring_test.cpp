#include "app/editor/scene/mesh_colouring.h"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/ball.h"
#include "tests/changed_shape.h"

// Which end of a scale a colour stands for, and what the legend says of it.

namespace homolog {

namespace {

/// A ball of 20 mm as placed; some of it changed.
struct Coloured {
  Document document = ball_document(20, 1);
  Eigen::Index n = document.view()->shape.points->rows();

  Shape& shape() { return test::changed_shape(document); }
  std::shared_ptr<const VertexScalars> all(double value) const {
    return std::make_shared<const VertexScalars>(VertexScalars::Constant(n, value));
  }
  /// Of the first vertex.
  Rgb colour(Colouring colouring, const VertexScalars* confidence = nullptr) {
    return mesh_colours(*document.view(), colouring, std::vector<float>(static_cast<std::size_t>(n), 0), 1,
                        confidence)[0];
  }
};

void same(const Rgb& a, const Rgb& b) {
  for (std::size_t c = 0; c < 3; ++c) CHECK(a[c] == doctest::Approx(b[c]).epsilon(1e-4));
}

Rgb between(const Rgb& a, const Rgb& b) {
  return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
}

}  // namespace

TEST_CASE("edges of half and twice their length have the ends of their scale") {
  Coloured ball;
  const Points before = *ball.shape().points;
  const auto scaled = [&](double by) {
    ball.shape().points = std::make_shared<const Points>(by * before);
    return ball.colour(Colouring::edge_stretch);
  };
  const Legend legend = colouring_legend(*ball.document.view(), Colouring::edge_stretch);
  REQUIRE(legend.colours.size() == 5);
  CHECK(legend.low == "0.5\xc3\x97");
  CHECK(legend.middle == "1\xc3\x97");
  CHECK(legend.high == "2\xc3\x97");
  CHECK(legend.colours.front()[2] > legend.colours.front()[0]);  // short is blue
  CHECK(legend.colours.back()[0] > legend.colours.back()[2]);    // long is red
  same(scaled(0.5), legend.colours.front());
  same(scaled(1), legend.colours[2]);
  same(scaled(std::sqrt(2)), legend.colours[3]);
  same(scaled(2), legend.colours.back());
  same(scaled(5), legend.colours.back());
}

TEST_CASE("the scale of what moved ends at a round number that the mesh fills") {
  Coloured ball;
  const Points before = *ball.shape().points;
  const auto moved_by = [&](double mm) {
    ball.shape().points = std::make_shared<const Points>(before.rowwise() + Eigen::RowVector3d(mm, 0, 0));
    return colouring_legend(*ball.document.view(), Colouring::moved);
  };
  for (const auto& [mm, high] : {std::pair(0.0, "2 mm"), std::pair(1.9, "2 mm"), std::pair(2.1, "5 mm"),
                                 std::pair(9.0, "10 mm"), std::pair(11.0, "20 mm"), std::pair(70.0, "100 mm")})
    CHECK(moved_by(mm).high == high);
  const Legend legend = moved_by(2.5);
  CHECK(legend.low == "0 mm");
  same(ball.colour(Colouring::moved), legend.colours[2]);  // half of 5 mm
  CHECK(moved_mm(*ball.document.view())[0] == doctest::Approx(2.5));
  // Light is far.
  CHECK(legend.colours.back()[1] > legend.colours.front()[1] + 0.5f);
}

TEST_CASE("stiffness and doubt and confidence begin and end where their legends say") {
  Coloured ball;
  ball.document.change({}, [&](Structure& first) { first.paint.stiffness = ball.all(1); });
  Legend legend = colouring_legend(*ball.document.view(), Colouring::stiffness);
  CHECK(legend.low == "0 soft");
  CHECK(legend.high == "stiff 2.0\xc3\x97");
  same(ball.colour(Colouring::stiffness), legend.colours[2]);
  ball.document.change({}, [&](Structure& first) { first.paint.stiffness = ball.all(8); });
  legend = colouring_legend(*ball.document.view(), Colouring::stiffness);
  CHECK(legend.high == "stiff 8.0\xc3\x97");
  same(ball.colour(Colouring::stiffness), legend.colours.back());

  const VertexScalars sure = VertexScalars::Ones(ball.n), unsure = VertexScalars::Zero(ball.n);
  legend = colouring_legend(*ball.document.view(), Colouring::confidence);
  CHECK(legend.low == "no edge seen");
  CHECK(legend.high == "clear edge");
  same(ball.colour(Colouring::confidence, &sure), legend.colours.back());
  same(ball.colour(Colouring::confidence, &unsure), legend.colours.front());

  ball.shape().doubt_mm = ball.all(0);
  const Legend doubts = colouring_legend(*ball.document.view(), Colouring::doubt);
  CHECK(doubts.low == "0 mm");
  CHECK(doubts.high == "\xe2\x89\xa5 5 mm");  // 6 % of the root of the area is 4.2 mm
  same(ball.colour(Colouring::doubt), doubts.colours.front());
  same(doubts.colours.front(), legend.colours.back());  // no doubt looks as a clear edge does
  ball.shape().doubt_mm = ball.all(5);
  same(ball.colour(Colouring::doubt), doubts.colours.back());
  ball.shape().doubt_mm = ball.all(50);
  same(ball.colour(Colouring::doubt), doubts.colours.back());
  ball.shape().confirmed = ball.all(0.5);  // which halves the doubt, too
  ball.shape().doubt_mm = ball.all(10);
  same(ball.colour(Colouring::doubt), between(doubts.colours.back(), {1, 1, 1}));
  CHECK(colouring_legend(*ball.document.view(), Colouring::doubt).has_confirmed);
  CHECK_FALSE(colouring_legend(*ball.document.view(), Colouring::moved).has_confirmed);
}

TEST_CASE("a vertex has the colour of its worst triangle and flat is the low end") {
  Coloured ball;
  const Legend legend = colouring_legend(*ball.document.view(), Colouring::quality);
  CHECK(legend.low == "flat");
  Points points = *ball.shape().points;
  const auto ring = ball.document.structure()->the_template->topology->one_ring(0);
  points.row(ring[0]) = points.row(ring[1]);  // one triangle around vertex 0 has no area
  ball.shape().points = std::make_shared<const Points>(points);
  same(ball.colour(Colouring::quality), legend.colours.front());
  CHECK(legend.colours.front()[0] > legend.colours.front()[1] + 0.3f);  // red
}

TEST_CASE("regions have their own colours in mesh and legend") {
  Coloured ball;
  auto regions = std::make_shared<Regions>();
  regions->list = {{"hilum", 1, {255, 0, 0}}, {"capsule", 1, {0, 0, 255}}};
  regions->of_vertex.assign(static_cast<std::size_t>(ball.n), 0);
  ball.document.change({}, [&](Structure& first) { first.paint.regions = regions; });
  const Legend legend = colouring_legend(*ball.document.view(), Colouring::regions);
  REQUIRE(legend.names.size() == 3);
  REQUIRE(legend.colours.size() == 3);
  CHECK(legend.names[1] == "hilum");
  CHECK(legend.names[2] == "capsule");
  same(legend.colours[1], {1, 0, 0});
  same(legend.colours[2], {0, 0, 1});
  for (const std::uint8_t number : {std::uint8_t{1}, std::uint8_t{2}}) {
    auto painted = std::make_shared<Regions>(*regions);
    painted->of_vertex[0] = number;
    ball.document.change({}, [&](Structure& first) { first.paint.regions = painted; });
    same(ball.colour(Colouring::regions), legend.colours[number]);
  }
}

TEST_CASE("what follows a gesture turns white and amber where it is stopped and the rest grey") {
  const std::vector<Rgb> red(2, Rgb{1, 0, 0});
  VertexScalars response(2);
  response << 1, 0;
  const auto free = tinted(red, response, false), stopped = tinted(red, response, true);
  same(free[0], {1, 0.65f, 0.65f});
  same(stopped[0], {1, 0.85f * 0.66f, 0.85f * 0.25f});
  CHECK(free[1] == stopped[1]);
  CHECK(free[1][0] < 0.9f);
}

TEST_CASE("what the scan lacks is grey and the legend says so") {
  Coloured ball;
  ball.shape().outlier = ball.all(1);
  same(ball.colour(Colouring::moved), outlier_grey);
  CHECK(colouring_legend(*ball.document.view(), Colouring::moved).has_outliers);
  ball.shape().outlier = ball.all(0);
  CHECK_FALSE(colouring_legend(*ball.document.view(), Colouring::moved).has_outliers);
}

TEST_CASE("what is decided and what is open have the colours that the legend names") {
  Coloured ball;
  const Legend legend = colouring_legend(*ball.document.view(), Colouring::known);
  REQUIRE(legend.names.size() == 3);
  CHECK(legend.names[0] == "confirmed");
  CHECK(legend.names[2] == "not known yet");
  same(ball.colour(Colouring::known), legend.colours[2]);
  ball.shape().decided = ball.all(0.59);  // carried along by a stroke, not decided
  same(ball.colour(Colouring::known), legend.colours[2]);
  ball.shape().decided = ball.all(0.6);
  same(ball.colour(Colouring::known), legend.colours[1]);
  ball.shape().confirmed = ball.all(1);
  same(ball.colour(Colouring::known), legend.colours[0]);
}

}  // namespace homolog
