#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "app/editor/scene/mesh_colouring.h"
#include "tests/ball.h"
#include "tests/changed_shape.h"
#include "tests/driver.h"
#include "tests/seen_colours.h"

// Whether what colours say is said to colour-blind eyes too.

namespace homolog {

namespace {

test::Light light_at(const std::vector<Rgb>& scale, double share) {
  const double place = share * static_cast<double>(scale.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(place), scale.size() - 2);
  const double t = place - static_cast<double>(low);
  std::array<double, 3> colour{};
  for (std::size_t k = 0; k < 3; ++k) colour[k] = (1 - t) * scale[low][k] + t * scale[low + 1][k];
  return test::light_of(colour);
}

}  // namespace

TEST_CASE("every scale of the mesh is read by eyes without one kind of cones") {
  Document document = ball_document(20);
  test::changed_shape(document).doubt_mm =
      std::make_shared<const VertexScalars>(VertexScalars::Ones(document.view()->shape.points->rows()));
  constexpr int steps = 9;
  for (const Colouring colouring : {Colouring::edge_stretch, Colouring::moved, Colouring::stiffness, Colouring::quality,
                                    Colouring::confidence, Colouring::doubt}) {
    const std::vector<Rgb> scale = colouring_legend(*document.view(), colouring).colours;
    REQUIRE(scale.size() > 2);
    for (const test::ColourVision& vision : test::colour_visions) {
      CAPTURE(static_cast<int>(colouring));
      CAPTURE(vision.name);
      std::vector<test::Light> seen;
      for (int k = 0; k < steps; ++k) seen.push_back(vision.seen(light_at(scale, k / (steps - 1.0))));
      for (std::size_t a = 0; a < seen.size(); ++a)
        for (std::size_t b = a + 1; b < seen.size(); ++b)
          CHECK(test::colour_difference(seen[a], seen[b]) > (b == a + 1 ? 6.5 : 12));
      // Lighter all the way, or darker; a scale with a middle is lightest there.
      const auto lightness = [&](std::size_t k) { return test::lab_of(seen[k])[0]; };
      const bool middle = colouring == Colouring::edge_stretch;
      const bool rises = middle || lightness(0) < lightness(seen.size() - 1);
      for (std::size_t k = 1; k < seen.size(); ++k) {
        const bool up = middle ? k <= seen.size() / 2 : rises;
        CHECK((up ? 1 : -1) * (lightness(k) - lightness(k - 1)) > 1);
      }
    }
  }
}

TEST_CASE("eight regions have colours that colour-blind eyes tell apart") {
  Driver driver(ball_document(20));
  driver.click("side panel/Template");
  for (const char* name : {"a", "b", "c", "d", "e", "f", "g", "h"}) {
    driver.type_into("new region", name);
    driver.press(key::enter);
    driver.settle();
  }
  const auto& list = driver.document().structure()->paint.regions->list;
  REQUIRE(list.size() == 8);
  const auto light = [](const std::array<std::uint8_t, 3>& colour) {
    return test::light_of({colour[0] / 255.0, colour[1] / 255.0, colour[2] / 255.0});
  };
  for (const test::ColourVision& vision : test::colour_visions)
    for (std::size_t a = 0; a < list.size(); ++a)
      for (std::size_t b = a + 1; b < list.size(); ++b) {
        CAPTURE(vision.name);
        CAPTURE(a);
        CAPTURE(b);
        CHECK(test::colour_difference(vision.seen(light(list[a].colour)), vision.seen(light(list[b].colour))) > 16);
      }
}

}  // namespace homolog
