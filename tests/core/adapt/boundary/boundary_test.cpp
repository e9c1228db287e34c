#include <doctest/doctest.h>

#include "core/adapt/boundary/boundary.h"
#include "core/adapt/boundary/partial_placements.h"
#include "core/adapt/boundary/surface_target.h"
#include "core/mesh/mesh_quality.h"
#include "tests/adapting.h"
#include "tests/shapes.h"

using namespace homolog;

TEST_CASE("a pocket behind a neck that the closing ball cannot pass is filled") {
  const auto grid = grid_around(icosphere(0, 20).points, 1);
  Volume mask = label_map(icosphere(4, 20), grid);
  auto& voxels = std::get<std::vector<std::uint8_t>>(mask.data);
  std::size_t v = 0;
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i, ++v) {
        const Vec3 p = grid.to_mm(Vec3(i, j, k));
        if (p.norm() < 8 || (p.z() > 0 && p.head<2>().norm() < 2)) voxels[v] = 0;
      }
  const auto volume_ml = [&](double closing_mm) {
    return enclosed_volume_ml(label_boundary(mask, 1, 0, closing_mm, 2500).value().surface);
  };
  const double sphere_ml = enclosed_volume_ml(icosphere(4, 20));
  CHECK(volume_ml(0) < 0.95 * sphere_ml);
  CHECK(volume_ml(3) == doctest::Approx(sphere_ml).epsilon(0.01));
}

TEST_CASE("the boundary of a scaled label map is the scaled boundary") {
  Volume mask = label_map(icosphere(3, 20), grid_around(icosphere(3, 20).points, 1));
  const Points usual = label_boundary(mask, 1, 0, std::nullopt, 600).value().surface.points;
  mask.geometry.spacing_mm /= 16;
  mask.geometry.origin_mm /= 16;
  const Points small = label_boundary(mask, 1, 0, std::nullopt, 600).value().surface.points;
  REQUIRE(small.rows() == usual.rows());
  CHECK(largest_difference(16 * small, usual) < 1e-6 * 70);
}

TEST_CASE("the largest part of a surface is its boundary") {
  const Mesh small = icosphere(1), large{small.topology, 10 * small.points};
  std::vector<Vec3> points;
  std::vector<std::array<std::int32_t, 3>> faces;
  for (const Mesh* part : {&small, &large}) {
    const auto first = static_cast<std::int32_t>(points.size());
    for (Eigen::Index v = 0; v < part->points.rows(); ++v) points.emplace_back(part->points.row(v));
    for (Eigen::Index f = 0; f < part->topology->triangles().rows(); ++f) {
      const auto t = part->topology->triangles().row(f);
      faces.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
  }
  const Boundary boundary = mesh_boundary(shapes::make_mesh(points, faces));
  CHECK(boundary.surface.points == large.points);
  CHECK(boundary.surface.topology->triangles() == large.topology->triangles());
  CHECK(boundary.warnings.size() == 1);
}

TEST_CASE("the counterpart of a vertex is where the boundary faces its way though the other side is nearer") {
  Mesh plate = icosphere(3, 30);
  plate.points.col(2) *= 0.1;  // 6 mm thick in its middle
  Mesh below = plate;
  below.points.col(2).array() -= 4;
  const Boundary boundary = mesh_boundary(plate);
  SurfaceTarget search(boundary, plate.points.rows());
  const TargetPull found = search.nearest(below);
  for (Eigen::Index i = 0; i < plate.points.rows(); ++i) {
    if (plate.points.row(i).head<2>().norm() > 10) continue;
    CHECK(found.weights[i] == 1);
    CHECK((found.targets(i, 2) > 0) == (plate.points(i, 2) > 0));
  }
}

TEST_CASE("other placements of a partial fit grow from the far end and move towards what is missing") {
  const Points points = icosphere(2, 20).points;
  const VertexScalars missing = (points.col(2).array() > 10).cast<double>();
  const Similarity found{Eigen::Quaterniond::Identity(), 2, Vec3(1, 2, 3)};
  const auto others = placements_towards(found, points, missing);
  REQUIRE(others.size() == other_placements);
  Eigen::Index lowest = 0;
  points.col(2).minCoeff(&lowest);
  const Vec3 kept = points.row(lowest), before = found.inverse().apply(kept);
  CHECK(others[0].scale == doctest::Approx(2 * 1.06));
  CHECK((others[0].apply(before) - kept).norm() < 1e-9);
  CHECK(others[1].scale == doctest::Approx(2 * 1.12));
  CHECK((others[1].apply(before) - kept).norm() < 1e-9);
  CHECK(others[2].scale == doctest::Approx(2));
  const Vec3 moved = others[2].translation - found.translation;
  CHECK(moved.z() == doctest::Approx(0.05 * bounds_of(points).diagonal().norm()).epsilon(0.01));
  CHECK(moved.head<2>().norm() < 0.1 * moved.z());
  CHECK(placements_towards(found, points, VertexScalars::Zero(points.rows())).empty());
}
