#include <doctest/doctest.h>

#include <chrono>
#include <thread>

#include "core/base/files/files.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/files/landmark_io.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/volume/volume_io.h"
#include "tests/beating_ball.h"
#include "tests/driver.h"
#include "tests/must.h"
#include "tests/organ_scan.h"

// What the window remembers follows the case: structures that come and go, other cases, other frames.

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// A further structure of the organ's template, beside the others.
void add_structure(Driver& driver, const std::string& id, const std::string& name) {
  const ShapeView first = *driver.document().view();
  Similarity beside = first.shape.placement;
  beside.translation += Vec3(45, 0, 0);
  driver.app().send(ApplyEdit{SetStructure{.id = id,
                                           .name = name,
                                           .source = first.the_template().source,
                                           .placement = beside,
                                           .the_template = first.structure.the_template}});
  driver.wait_until("it is there", [&] { return driver.document().structure(id) != nullptr; });
  driver.settle();
}

}  // namespace

TEST_CASE("landmarks for a case without a template are refused") {
  Driver driver(new_document({}, nullptr, nullptr));
  const fs::path file = driver.folder() / "points.fcsv";
  REQUIRE(write_landmarks({{"hilum", Vec3(1, 2, 3)}}, file));
  driver.app().send(ImportLandmarks{{file}});
  driver.settle();
  CHECK(driver.shows("There is no mesh yet."));
}

TEST_CASE("what is read for a structure does not go to another one that was chosen meanwhile") {
  const OrganScan scan;
  Driver driver(scan.document());
  add_structure(driver, "s2", "second");
  const fs::path points = driver.folder() / "points.fcsv";
  REQUIRE(write_landmarks({{"hilum", Vec3(1, 2, 3)}}, points));
  driver.app().send(ImportLandmarks{{points}});
  driver.app().send(ChooseStructure{"s2"});
  driver.settle();
  CHECK(driver.shows("points.fcsv was not imported, because another structure was chosen meanwhile."));
  for (const auto& one : driver.document().structures) CHECK(one->shape(0)->landmarks.empty());
}

TEST_CASE("a click that waits for a second one is done in its own case when another opens") {
  const OrganScan scan;
  Driver driver(scan.document());
  driver.app().send(ApplyEdit{SetLandmarkPull{LandmarkPull::off}, false});
  driver.press('L');
  driver.settle();
  const fs::path before = driver.case_file(), other = driver.folder() / "other.ply";
  REQUIRE(write_mesh(icosphere(2, 10), other));
  const auto click = [&] {
    const ViewMap map = view_map(driver.state(), driver.app().layout(), driver.document(), ViewKind::axial);
    const Eigen::Vector2d at = *map.to_px(driver.state().look.crosshair_mm);
    driver.frames(70);
    driver.move(at.x(), at.y());
    driver.button(MouseButton::left, true);
    driver.button(MouseButton::left, false);
    REQUIRE(driver.state().pointer.held_click);
  };
  click();
  driver.app().send(open_template(other.string()));
  for (int k = 0; k < 15 && driver.case_file() == before; ++k) {  // less than the time of a double click
    driver.frame();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  driver.wait_until("the other case is open", [&] { return driver.case_file() != before; });
  driver.settle();
  CHECK(driver.document().view()->shape.landmarks.empty());
  CHECK(test::must(read_whole_file(before)).find("{\"landmark\":") != std::string::npos);

  // One that nobody can do any more is dropped.
  driver.app().start_session(EditSession(scan.document()));
  driver.settle();
  driver.press('L');
  driver.settle();
  click();
  driver.app().start_session(EditSession(new_document({}, nullptr, nullptr)));
  CHECK_FALSE(driver.state().pointer.held_click);
  driver.frames(70);
  CHECK(driver.document().structures.empty());
}

TEST_CASE("undo of a removal goes on with the structure that is worked on") {
  const OrganScan scan;
  Driver driver(scan.document());
  add_structure(driver, "s2", "second");
  driver.app().send(ApplyEdit{RemoveStructure{"s1"}});
  driver.settle();
  CHECK(driver.state().look.structure.empty());
  REQUIRE(driver.document().structures.size() == 1);
  driver.app().send(ApplyEdit{Undo{}});
  driver.settle();
  REQUIRE(driver.document().structures.size() == 2);
  CHECK(driver.state().look.structure == "s2");
}

TEST_CASE("a row that the filter takes away is chosen no more") {
  const OrganScan scan;
  Driver driver(scan.document());
  add_structure(driver, "s2", "second");
  driver.app().send(ClickStructure{"s1", true, false});
  driver.app().send(ClickStructure{"s2", true, false});
  driver.settle();
  REQUIRE(rows_with(driver.state().look.structures, "s2").size() == 2);
  driver.app().send(FilterStructures{"second"});
  driver.settle();
  CHECK(rows_with(driver.state().look.structures, "s2") == std::vector<std::string>{"s2"});
}

TEST_CASE("meshes of structures that are called alike are all written") {
  const OrganScan scan;
  Driver driver(scan.document());
  driver.app().send(ApplyEdit{SetStructure{.id = "s1", .name = "rib"}});
  add_structure(driver, "s2", "rib-2");
  add_structure(driver, "s3", "rib");
  const fs::path folder = driver.folder() / "meshes";
  driver.app().send(ExportStructuresMeshes{{folder}});
  driver.settle();
  for (const char* name : {"rib.ply", "rib-2.ply", "rib-3.ply"}) CHECK(fs::exists(folder / name));
}

TEST_CASE("a fit to a structure that is locked meanwhile changes nothing") {
  const OrganScan scan;
  Driver driver(scan.document());
  const fs::path map = driver.folder() / "map.nii.gz";
  REQUIRE(write_volume(label_map(icosphere(4, 22), OrganScan::grid(), 3), map));
  driver.app().send(open_labels(map));
  driver.settle();
  const Points before = *driver.document().view()->shape.points;
  FitSettings settings;
  settings.label = 3;
  driver.app().send(StartFit{settings});
  driver.app().send(LockStructures{{"s1"}, true});
  driver.wait_until("it is refused", [&] { return driver.shows("is locked."); });
  driver.settle();
  CHECK(*driver.document().view()->shape.points == before);
  CHECK_FALSE(driver.state().found.last_fit);
  driver.wait_until("the preview is gone", [&] { return !driver.app().snapshot().preview; });
}

TEST_CASE("what shares vertices with a structure goes along when that one is fitted and one undo takes both back") {
  const OrganScan scan;
  Driver driver(scan.document());
  add_structure(driver, "s2", "second");
  std::vector<VertexPair> pairs;
  for (std::int32_t v = 0; v < 20; ++v) pairs.push_back({v, v});
  const auto shared = std::make_shared<const std::vector<VertexPair>>(pairs);
  driver.app().send(ApplyEdit{SetStructure{.id = "s2", .shared = {{{"s1", shared}}}}});
  driver.settle();
  const fs::path map = driver.folder() / "map.nii.gz";
  REQUIRE(write_volume(label_map(icosphere(4, 22), OrganScan::grid(), 3), map));
  driver.app().send(open_labels(map));
  driver.settle();
  const auto points = [&](const char* id) { return *driver.document().view(id)->shape.points; };
  const auto apart_mm = [&] { return (points("s1") - points("s2")).topRows(20).rowwise().norm().maxCoeff(); };
  const Points first = points("s1"), second = points("s2");
  REQUIRE(apart_mm() > 40);
  FitSettings settings;
  settings.label = 3;
  driver.app().send(StartFit{settings});
  driver.wait_until("the fit is done", [&] { return driver.state().found.last_fit.has_value(); });
  driver.settle();
  CHECK(points("s1") != first);
  CHECK(apart_mm() < 1e-6);
  driver.app().send(ApplyEdit{Undo{}});
  driver.settle();
  CHECK(points("s1") == first);
  CHECK(points("s2") == second);
}

TEST_CASE("nothing is fitted to a map that belongs to another frame") {
  Driver driver(BeatingBall::document());
  const fs::path map = driver.folder() / "one.nii.gz";
  REQUIRE(write_volume(label_map(icosphere(3, 10), driver.document().scan.image->geometry, 2), map));
  driver.app().send(open_labels(map));
  driver.settle();
  driver.app().send(SetLabelsFrame{3});
  driver.settle();
  const Points before = *driver.document().view()->shape.points;
  FitSettings settings;
  settings.label = 2;
  driver.app().send(StartFit{settings});
  driver.settle();
  CHECK(driver.shows("The label map belongs to frame 3."));
  CHECK(*driver.document().view()->shape.points == before);
}

}  // namespace homolog
