#include "core/measure/meeting.h"

#include <doctest/doctest.h>

#include <limits>

#include "core/mesh/construction/icosphere.h"

using namespace homolog;

namespace {

/// An egg with a bump, so that no turn brings it onto itself, far from the origin as in a scan.
Mesh organ() {
  Mesh mesh = icosphere(4, 30);
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i) {
    Vec3 p = mesh.points.row(i);
    p = p.cwiseProduct(Vec3(1, 0.7, 1.6));
    if (p.z() > 20) p.x() += 0.5 * (p.z() - 20);
    mesh.points.row(i) = p + Vec3(60, -90, 140);
  }
  return mesh;
}

Mesh times(Mesh mesh, const Vec3& by) {
  mesh.points = mesh.points * by.asDiagonal();
  return mesh;
}

VolumeGeometry grid_around(const Mesh& mesh) {
  const Box box = bounds_of(mesh.points);
  VolumeGeometry grid;
  grid.spacing_mm.setConstant(2);
  grid.origin_mm = box.min() - Vec3::Constant(20);
  for (std::size_t axis = 0; axis < 3; ++axis)
    grid.dims[axis] = static_cast<int>(box.sizes()[static_cast<Eigen::Index>(axis)] / 2) + 20;
  return grid;
}

}  // namespace

TEST_CASE("a mesh in another unit or in RAS is told from its label by what brings it there") {
  const Mesh label = organ();
  struct Case {
    Vec3 by;
    double factor;
    bool half_turn;
  };
  for (const Case& one :
       {Case{{1e-3, 1e-3, 1e-3}, 1e3, false}, Case{{0.1, 0.1, 0.1}, 10, false}, Case{{1e3, 1e3, 1e3}, 1e-3, false},
        Case{{-1, -1, 1}, 1, true}, Case{{-1e-3, -1e-3, 1e-3}, 1e3, true}}) {
    CAPTURE(one.by.transpose());
    const auto misfit = misfit_in_scan(times(label, one.by), label);
    REQUIRE(misfit);
    CHECK(misfit->factor == one.factor);
    CHECK(misfit->half_turn == one.half_turn);
  }
}

TEST_CASE("a mesh that fits its label, or is another organ near it, is no misfit") {
  const Mesh label = organ();
  CHECK(!misfit_in_scan(label, label));
  Mesh beside = label;
  beside.points.rowwise() += Vec3(40, 25, -30).transpose();
  CHECK(!misfit_in_scan(beside, label));
  CHECK(!misfit_in_scan(times(label, {0.5, 0.5, 0.5}), label));
}

TEST_CASE("sizes alone count from fifty times on, so that a mouse is no man in another unit") {
  CHECK(!misfit_of_size(10, 200));
  CHECK(!misfit_of_size(200, 10));
  REQUIRE(misfit_of_size(0.1, 100));
  CHECK(misfit_of_size(0.1, 100)->factor == 1e3);
  CHECK(misfit_of_size(100, 0.1)->factor == 1e-3);
  CHECK(!misfit_of_size(0, 100));
  CHECK(!misfit_of_size(std::numeric_limits<double>::infinity(), 100));
}

TEST_CASE("a mesh and the image that it should lie in") {
  const Mesh mesh = organ();
  const VolumeGeometry image = grid_around(mesh);
  const auto in = [&](const Vec3& by) { return misfit_in_image(bounds_of(times(mesh, by).points), image); };
  CHECK(!in({1, 1, 1}));
  REQUIRE(in({-1, -1, 1}));
  CHECK(in({-1, -1, 1})->half_turn);
  CHECK(in({-1, -1, 1})->factor == 1);
  REQUIRE(in({1e-3, 1e-3, 1e-3}));
  CHECK(in({1e-3, 1e-3, 1e-3})->factor == 1e3);
  CHECK(!in({1e-3, 1e-3, 1e-3})->half_turn);
  REQUIRE(in({1e3, 1e3, 1e3}));
  CHECK(in({1e3, 1e3, 1e3})->factor == 1e-3);
  // A small organ in a large image is none.
  CHECK(!misfit_in_image(Box(Vec3(60, -90, 140), Vec3(66, -84, 146)), image));
}

TEST_CASE("the sentence blames whose size no organ has and names the remedy") {
  CHECK(misfit_sentence({1e3, false}, {"a.ply", 0.2}, {"b.nii.gz", 200}) ==
        "a.ply: is 1,000 times smaller than b.nii.gz; are its lengths in metres? If they are, convert it by convert "
        "--times 1000");
  const std::string map = misfit_sentence({1e-3, false}, {"a.ply", 200}, {"b.nii.gz", 0.2});
  CHECK(map.starts_with("b.nii.gz: is 1,000 times smaller than a.ply"));
  CHECK(map.find("voxel size in its header") != std::string::npos);
  CHECK(misfit_sentence({1, true}, {"a.ply", 200}, {"b.nii.gz", 200}).find("convert --from-ras") != std::string::npos);
}

TEST_CASE("of many, those of another size than most are named") {
  const auto said =
      misfits_among({{"a.ply", 100}, {"b.ply", 120}, {"c.ply", 0.11}, {"d.ply", 300}}, "the other shapes");
  REQUIRE(said.size() == 1);
  CHECK(said[0].starts_with("c.ply: is 1,000 times smaller than the other shapes"));
  CHECK(misfits_among({{"a.ply", 100}}, "the other shapes").empty());
  // Of two, the one that no organ can be.
  const auto of_two = misfits_among({{"a.ply", 0.1}, {"b.ply", 100}}, "the other shapes");
  REQUIRE(of_two.size() == 1);
  CHECK(of_two[0].starts_with("a.ply"));
}
