#include "core/template_making/label_surface.h"

#include <doctest/doctest.h>

#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/mesh/voxels/label_map.h"
#include "tests/must.h"

namespace homolog {

namespace {

VolumeGeometry thick_grid(double slice_mm) {
  VolumeGeometry grid;
  grid.dims = {48, 48, static_cast<int>(72 / slice_mm)};
  grid.spacing_mm = Vec3(1.5, 1.5, slice_mm);
  grid.origin_mm = Vec3(-35.25, -35.25, -(grid.dims[2] - 1) * slice_mm / 2);
  return grid;
}

/// How far the normals of a ball's surface turn from those of the ball, degrees on average.
double roughness_deg(const Mesh& surface) {
  const Points normals = vertex_normals(surface);
  double sum = 0;
  for (Eigen::Index i = 0; i < normals.rows(); ++i)
    sum += std::acos(std::clamp(normals.row(i).dot(surface.points.row(i).normalized()), -1.0, 1.0));
  return sum / static_cast<double>(normals.rows()) * 180 / 3.14159265;
}

}  // namespace

TEST_CASE("the surface of a label that is shown is smooth and lies where the label does") {
  for (const double slice_mm : {1.5, 6.0}) {
    const Volume labels = label_map(icosphere(4, 25), thick_grid(slice_mm), 3);
    const Mesh surface = test::must(label_surface(labels, 3, 0)), stairs = test::must(mask_surface(labels, 3));
    const Eigen::VectorXd radius = surface.points.rowwise().norm();
    CAPTURE(slice_mm);
    CHECK(radius.mean() == doctest::Approx(25).epsilon(0.015));
    CHECK((radius.array() - 25).abs().maxCoeff() < 0.75 * slice_mm);
    CHECK(roughness_deg(surface) < 0.7 * roughness_deg(stairs));
    CHECK(surface.topology->closed());
    CHECK(test::must(label_surface(labels, every_label, 0)).points == surface.points);
  }
}

TEST_CASE("the surface of a label holds all its parts and a label that is absent is named") {
  Volume labels = label_map(icosphere(3, 10, Vec3(-18, 0, 0)), thick_grid(1.5), 2);
  const Volume other = label_map(icosphere(3, 7, Vec3(20, 0, 0)), thick_grid(1.5), 2);
  std::visit(
      [&](auto& voxels) {
        using Voxels = std::decay_t<decltype(voxels)>;
        const auto& more = std::get<Voxels>(other.data);
        for (std::size_t i = 0; i < voxels.size(); ++i) voxels[i] = std::max(voxels[i], more[i]);
      },
      labels.data);
  const Mesh surface = test::must(label_surface(labels, 2, 0));
  CHECK(surface.points.col(0).minCoeff() < -27);
  CHECK(surface.points.col(0).maxCoeff() > 26);
  const auto none = label_surface(labels, 5, 0);
  REQUIRE_FALSE(none);
  CHECK(none.error().sentence().find("label 5") != std::string::npos);
  Progress progress;
  progress.cancel();
  CHECK_FALSE(label_surface(labels, 2, 0, &progress));
}

}  // namespace homolog
