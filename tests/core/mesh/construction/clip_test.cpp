#include "core/mesh/construction/clip.h"

#include <doctest/doctest.h>

#include <numbers>

#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_quality.h"

using namespace homolog;

TEST_CASE("a ball cut by a plane keeps the part within, open and with its area") {
  const Mesh ball = icosphere(5, 20);
  for (const double height : {-10.0, 0.3, 12.0}) {
    CAPTURE(height);
    const auto part = clipped(ball, Vec3::UnitZ(), height);
    REQUIRE(part);
    CHECK(part->points.col(2).maxCoeff() == doctest::Approx(height));
    CHECK(part->topology->rims().size() == 1);
    // Archimedes: the area of a cap is that of the cylinder around it.
    CHECK(surface_area_mm2(*part) == doctest::Approx(2 * std::numbers::pi * 20 * (20 + height)).epsilon(0.005));
  }
}

TEST_CASE("a plane that misses a surface keeps all of it or nothing") {
  const Mesh ball = icosphere(3, 20);
  const auto all = clipped(ball, Vec3::UnitX(), 25);
  REQUIRE(all);
  CHECK(all->topology->closed());
  CHECK(surface_area_mm2(*all) == doctest::Approx(surface_area_mm2(ball)));
  CHECK(!clipped(ball, Vec3::UnitX(), -25));
}

TEST_CASE("a plane through vertices cuts too") {
  // An icosphere has vertices at exactly 0.
  const auto part = clipped(icosphere(3, 20), Vec3::UnitZ(), 0);
  REQUIRE(part);
  CHECK(surface_area_mm2(*part) == doctest::Approx(2 * std::numbers::pi * 400).epsilon(0.02));
}
