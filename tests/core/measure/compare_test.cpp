#include "core/measure/compare.h"

#include <doctest/doctest.h>

#include "core/mesh/mesh_quality.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/mesh/voxels/voxelise.h"
#include "core/volume/volume_io.h"
#include "tests/real_data.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

Volume mask_from(const Mesh& mesh, double spacing_mm, std::uint8_t label) {
  Volume mask;
  const Box box = bounds_of(mesh.points);
  mask.geometry.spacing_mm.setConstant(spacing_mm);
  mask.geometry.origin_mm = box.min() - Vec3::Constant(2 * spacing_mm);
  for (std::size_t axis = 0; axis < 3; ++axis)
    mask.geometry.dims[axis] = static_cast<int>(box.sizes()[static_cast<Eigen::Index>(axis)] / spacing_mm) + 5;
  auto voxels = voxelise(mesh, mask.geometry);
  for (auto& voxel : voxels) voxel = static_cast<std::uint8_t>(voxel * label);
  mask.data = std::move(voxels);
  return mask;
}

}  // namespace

TEST_CASE("a mesh agrees with itself perfectly") {
  const Mesh mesh = shapes::torus(40, 20, 20, 8);
  const Agreement agreement = compare_meshes(mesh, mesh);
  CHECK(agreement.dice == 1);
  CHECK(agreement.assd_mm < 1e-12);
  CHECK(agreement.hausdorff_mm < 1e-12);
  CHECK(agreement.vertex_max_mm == 0);
}

TEST_CASE("concentric spheres are as far apart as their radii and overlap as their volumes") {
  const Mesh inner = icosphere(4, 20), outer = icosphere(5, 23);
  const Agreement agreement = compare_meshes(inner, outer);
  CHECK(agreement.assd_mm == doctest::Approx(3).epsilon(0.01));
  CHECK(agreement.hd95_mm == doctest::Approx(3).epsilon(0.01));
  CHECK(agreement.hausdorff_mm == doctest::Approx(3).epsilon(0.02));
  const double a = 20.0 * 20 * 20, b = 23.0 * 23 * 23;
  CHECK(agreement.dice == doctest::Approx(2 * a / (a + b)).epsilon(0.005));
  CHECK(!agreement.vertex_mean_mm);
}

TEST_CASE("a gap that only one direction sees is seen") {
  const Mesh whole = shapes::open_cylinder(41, 40, 10, 40), half = shapes::open_cylinder(21, 40, 10, 20);
  for (const Agreement& agreement : {compare_meshes(whole, half), compare_meshes(half, whole)}) {
    CHECK(agreement.hausdorff_mm == doctest::Approx(20));
    CHECK(agreement.hd95_mm == doctest::Approx(18).epsilon(0.01));
    CHECK(agreement.assd_mm == doctest::Approx(20.0 / 2 / 3).epsilon(0.01));
    CHECK(agreement.dice == doctest::Approx(2.0 / 3).epsilon(0.01));
  }
}

TEST_CASE("the mean distance does not depend on how finely either surface is cut") {
  const Mesh coarse = shapes::box({0, 0, 0}, {30, 20, 10});
  Mesh sphere = icosphere(3, 12, {15, 10, 5});
  const double there = compare_meshes(coarse, sphere).assd_mm, back = compare_meshes(sphere, coarse).assd_mm;
  CHECK(there == doctest::Approx(back).epsilon(1e-9));
  // The box again with each side cut into 800 triangles.
  std::vector<Vec3> points;
  std::vector<std::array<std::int32_t, 3>> faces;
  const Triangles& t = coarse.topology->triangles();
  std::map<std::array<double, 3>, std::int32_t> vertex;
  constexpr int n = 20;
  for (Eigen::Index f = 0; f < t.rows(); ++f) {
    const auto at = [&](int i, int j) {
      const Vec3 p =
          (coarse.points.row(t(f, 0)) * (n - i - j) + coarse.points.row(t(f, 1)) * i + coarse.points.row(t(f, 2)) * j) /
          n;
      const auto [found, added] = vertex.try_emplace({p.x(), p.y(), p.z()}, static_cast<std::int32_t>(points.size()));
      if (added) points.push_back(p);
      return found->second;
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        faces.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
        if (i + j + 1 < n) faces.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
      }
  }
  const Mesh fine = shapes::make_mesh(points, faces);
  CHECK(compare_meshes(fine, sphere).assd_mm == doctest::Approx(there).epsilon(0.002));
}

TEST_CASE("vertices are compared where the topology is the same") {
  const Mesh mesh = icosphere(2, 10);
  Mesh moved = mesh;
  moved.points.rowwise() += Eigen::RowVector3d(3, 0, 4);
  const Agreement agreement = compare_meshes(mesh, moved);
  CHECK(*agreement.vertex_mean_mm == doctest::Approx(5));
  CHECK(*agreement.vertex_max_mm == doctest::Approx(5));
  moved.points.rowwise() += Eigen::RowVector3d(500, 0, 0);
  CHECK(compare_meshes(mesh, moved).dice == 0);
}

TEST_CASE("a mesh against the mask made of it has Dice 1 and distances below a voxel") {
  const Mesh mesh = shapes::torus(40, 20, 20, 8);
  const Volume mask = mask_from(mesh, 1, 5);
  const Agreement agreement = compare_with_mask(mesh, mask, 5).value();
  CHECK(agreement.dice == 1);
  CHECK(agreement.assd_mm < 0.3);
  CHECK(agreement.hausdorff_mm < 1);
  CHECK(compare_with_mask(mesh, mask, 4).error().what.find("label 4") != std::string::npos);
  const Agreement exact = compare_with_mask(mask_surface(mask, 5).value(), mask, 5).value();
  CHECK(exact.dice == 1);
  CHECK(exact.assd_mm < 1e-12);
}

TEST_CASE("the label to use is the only one or else they are named") {
  Volume mask = mask_from(icosphere(2, 5), 1, 4);
  CHECK(only_label(mask).value() == 4);
  std::get<std::vector<std::uint8_t>>(mask.data)[0] = 9;
  CHECK(only_label(mask).error().what.find("4, 9") != std::string::npos);
  mask.data = std::vector<std::uint8_t>(mask.geometry.voxels(), 0);
  CHECK(only_label(mask).error().what.find("no label") != std::string::npos);
}
