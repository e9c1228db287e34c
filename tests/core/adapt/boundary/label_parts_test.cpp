#include "core/adapt/boundary/label_parts.h"

#include <doctest/doctest.h>

#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_quality.h"
#include "tests/adapting.h"

// Labels in several parts: which are a fit's target, and what is said of the others.

namespace homolog {

namespace {

/// Balls of 10, 9 and 5 mm, 30 mm apart along x; the middle one is the largest.
Volume three_balls() {
  Volume mask = label_map(icosphere(3, 36), grid_around(icosphere(0, 50).points, 1));
  auto& voxels = std::get<std::vector<std::uint8_t>>(mask.data);
  const VolumeGeometry& grid = mask.geometry;
  std::size_t v = 0;
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i, ++v) {
        const Vec3 p = grid.to_mm(Vec3(i, j, k)), apart(30, 0, 0);
        voxels[v] = p.norm() < 10 || (p - apart).norm() < 9 || (p + apart).norm() < 5 ? 1 : 0;
      }
  return mask;
}

double ball_ml(double radius_mm) {
  return enclosed_volume_ml(icosphere(4, radius_mm));
}

}  // namespace

TEST_CASE("parts that are left out are said with their count and share") {
  const Boundary largest = label_boundary(three_balls(), 1, 0, 0, 600).value();
  CHECK(enclosed_volume_ml(largest.surface) == doctest::Approx(ball_ml(10)).epsilon(0.03));
  CHECK(largest.parts_left_out == 2);
  CHECK(largest.parts_alike == 2);
  CHECK(largest.share_left_out == doctest::Approx(854.0 / 1854).epsilon(0.02));
  REQUIRE(largest.warnings.size() == 1);
  CHECK(largest.warnings.front().find("has 3 parts, 2 of about one size") != std::string::npos);
  CHECK(largest.warnings.front().find("46 % of its volume") != std::string::npos);
  CHECK(largest.warnings.front().find("--parts all") != std::string::npos);
}

TEST_CASE("all parts of a label or one of them are a boundary") {
  const Boundary all = label_boundary(three_balls(), 1, 0, 0, 600, {true, 0}).value();
  CHECK(all.surface.topology->components() == 3);
  CHECK(enclosed_volume_ml(all.surface) == doctest::Approx(ball_ml(10) + ball_ml(9) + ball_ml(5)).epsilon(0.03));
  CHECK(all.warnings.empty());
  CHECK(all.parts_left_out == 0);
  const Boundary second = label_boundary(three_balls(), 1, 0, 0, 600, {false, 1}).value();
  CHECK(enclosed_volume_ml(second.surface) == doctest::Approx(ball_ml(9)).epsilon(0.03));
  CHECK(second.surface.points.col(0).mean() == doctest::Approx(30).epsilon(0.01));
  CHECK_FALSE(label_boundary(three_balls(), 1, 0, 0, 600, {false, 3}));
}

}  // namespace homolog
