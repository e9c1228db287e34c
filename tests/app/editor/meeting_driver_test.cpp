#include <doctest/doctest.h>

#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/volume/volume_io.h"
#include "tests/driver.h"
#include "tests/temporary_folder.h"

using namespace homolog;
namespace fs = std::filesystem;

namespace {

constexpr double at_x = 60, at_y = -90, at_z = 140;

/// A ball of 20 mm in an image far from the origin.
struct FarScan {
  TemporaryFolder folder;
  fs::path image = folder.path / "far.nii";

  FarScan() { REQUIRE(write_volume(label_map(ball(20), grid(), 100), image)); }
  static Mesh ball(double radius_mm) {
    Mesh mesh = icosphere(3, radius_mm);
    mesh.points.rowwise() += Vec3(at_x, at_y, at_z).transpose();
    return mesh;
  }
  static VolumeGeometry grid() {
    VolumeGeometry grid;
    grid.dims = {40, 40, 40};
    grid.spacing_mm.setConstant(2);
    grid.origin_mm = Vec3(at_x, at_y, at_z) - Vec3::Constant(39);
    return grid;
  }
  fs::path mesh(const std::string& name, const Vec3& times) const {
    Mesh mesh = ball(20);
    mesh.points = mesh.points * times.asDiagonal();
    REQUIRE(write_mesh(mesh, folder.path / name));
    return folder.path / name;
  }
};

}  // namespace

TEST_CASE("a template in RAS is asked about, one in metres is said, one in place is neither") {
  const FarScan scan;
  Driver driver(new_document({}, nullptr, nullptr));
  const auto open = [&](const fs::path& mesh) {
    driver.state().notices.clear();
    driver.app().send(OpenFiles{{scan.image, mesh}});
    driver.wait_until("the template is there", [&] {
      return driver.document().structure() != nullptr &&
             driver.document().structure()->the_template->source == mesh.string();
    });
    driver.settle();
  };
  open(scan.mesh("right.ply", {1, 1, 1}));
  CHECK(!driver.shows("Are the mesh's coordinates RAS?"));
  CHECK(driver.state().notices.empty());

  open(scan.mesh("ras.ply", {-1, -1, 1}));
  REQUIRE(driver.shows("Are the mesh's coordinates RAS?"));
  driver.click("Are the mesh's coordinates RAS?/Flip RAS to LPS");
  driver.settle();
  const Points& points = *driver.document().view()->shape.points;
  CHECK((points.colwise().mean().transpose() - Vec3(at_x, at_y, at_z)).norm() < 0.5);

  open(scan.mesh("metres.ply", {1e-3, 1e-3, 1e-3}));
  CHECK(!driver.shows("Are the mesh's coordinates RAS?"));
  REQUIRE(!driver.state().notices.empty());
  CHECK(driver.state().notices.back().text.starts_with("metres.ply: is 1,000 times smaller than far.nii"));
}

TEST_CASE("a label map whose header means RAS for LPS is said to be turned") {
  const FarScan scan;
  Driver driver(new_document({}, nullptr, nullptr));
  driver.app().send(OpenFiles{{scan.image}});
  driver.wait_until("the image is open", [&] { return driver.document().scan.source == scan.image.string(); });
  driver.settle();
  Volume labels = label_map(FarScan::ball(20), FarScan::grid(), 1);
  labels.geometry.origin_mm = labels.geometry.origin_mm.cwiseProduct(Vec3(-1, -1, 1));
  labels.geometry.direction = Vec3(-1, -1, 1).asDiagonal() * labels.geometry.direction;
  REQUIRE(write_volume(labels, scan.folder.path / "turned.nii"));
  driver.state().notices.clear();
  driver.app().send(open_labels(scan.folder.path / "turned.nii"));
  driver.settle();
  REQUIRE(driver.state().notices.size() == 1);
  CHECK(driver.state().notices.front().text.starts_with("turned.nii lies outside the image"));
  CHECK(driver.state().notices.front().text.find("RAS for LPS") != std::string::npos);
}
