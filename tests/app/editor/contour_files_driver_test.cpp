#include <doctest/doctest.h>

#include "app/editor/update/controls.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/session/case_file.h"
#include "tests/core/volume/structure_set_file.h"
#include "tests/driver.h"
#include "tests/must.h"

// Structure sets (RTSTRUCT) that are opened in the window, and what of them stays with the case.

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// A case without an image that has two structures, "liver" (s1) and "spleen" (s2).
Document two_balls() {
  MeshFile file{icosphere(3, 20).points, icosphere(3, 20).topology->triangles()};
  const auto ball = test::must(make_template(file, "ball"));
  Document document = new_document("", nullptr, ball);
  document.change(document.structures.front()->id, [](Structure& held) { held.name = "liver"; });
  Structure more = new_structure(ball, Similarity{});
  more.id = "s2";
  more.name = "spleen";
  document.structures.push_back(std::make_shared<const Structure>(std::move(more)));
  return document;
}

const Structure& called(const Driver& driver, const std::string& name) {
  for (const auto& one : driver.document().structures)
    if (one->name == name) return *one;
  throw std::runtime_error("no structure " + name);
}

/// Of three structures, each a square; "Liver" is called as the case's is.
fs::path structure_set(const fs::path& folder) {
  RtFile file;
  file.names = {"aorta", "Liver", "stomach"};
  for (int roi = 1; roi <= 3; ++roi)
    file.drawn.push_back({roi, "CLOSED_PLANAR", "20\\0\\0\\0\\20\\0\\-20\\0\\0\\0\\-20\\0"});
  write_bytes(folder / "rt.dcm", file.bytes());
  return folder / "rt.dcm";
}

}  // namespace

TEST_CASE("of a structure set those that are called like structures are taken and the others are offered") {
  const TemporaryFolder folder;
  Driver driver(two_balls());
  driver.settle();
  driver.app().send(ChooseStructure{"s2"});
  driver.settle();
  driver.app().send(ApplyEdit{SetStiffnessBase{7}});
  driver.settle();
  driver.app().send(OpenFiles{{structure_set(folder.path)}});
  driver.wait_until("the others are offered", [&] { return driver.shows("In rt.dcm"); });
  driver.settle();
  REQUIRE(called(driver, "liver").contours.size() == 1);
  CHECK(called(driver, "liver").contours.front()->name == "Liver");
  CHECK(called(driver, "spleen").contours.empty());
  CHECK(driver.shows("holds 2 more structures"));
  driver.click("aorta/aorta");
  driver.settle();
  REQUIRE(called(driver, "spleen").contours.size() == 1);
  CHECK(called(driver, "spleen").contours.front()->name == "aorta");
  driver.app().send(LockStructures{{"s2"}, true});
  driver.settle();
  driver.click("stomach/stomach");
  driver.settle();
  CHECK(called(driver, "spleen").contours.size() == 1);
  CHECK(driver.shows("\"spleen\" is locked"));
  driver.app().send(open_phantom(Organ::kidney, 2));
  driver.wait_until("another case is open", [&] { return driver.document().structures.size() == 1; });
  driver.settle();
  CHECK_FALSE(driver.shows("In rt.dcm"));
}

TEST_CASE("contours that a lock refuses join no edit before to those that are added") {
  const TemporaryFolder folder;
  Driver driver(two_balls());
  driver.settle();
  driver.app().send(ApplyEdit{SetStiffnessBase{7}});
  driver.settle();
  driver.app().send(LockStructures{{"s1"}, true});
  RtFile file;
  file.names = {"liver", "spleen"};
  for (int roi = 1; roi <= 2; ++roi)
    file.drawn.push_back({roi, "CLOSED_PLANAR", "20\\0\\0\\0\\20\\0\\-20\\0\\0\\0\\-20\\0"});
  write_bytes(folder.path / "rt.dcm", file.bytes());
  driver.app().send(OpenFiles{{folder.path / "rt.dcm"}});
  driver.wait_until("the spleen's are there", [&] { return called(driver, "spleen").contours.size() == 1; });
  driver.settle();
  CHECK(called(driver, "liver").contours.empty());
  driver.press('Z', {.ctrl = true});
  driver.settle();
  CHECK(called(driver, "spleen").contours.empty());
  CHECK(called(driver, "liver").paint.base == 7);
}

TEST_CASE("a contour that gets the id of a hidden one that is gone is shown") {
  const TemporaryFolder folder;
  Driver driver(two_balls());
  driver.settle();
  const auto curves = std::make_shared<const std::vector<Contour>>(
      std::vector<Contour>{{{Vec3(20, 0, 0), Vec3(0, 20, 0), Vec3(-20, 0, 0), Vec3(0, -20, 0)}}});
  const auto add = [&] {
    driver.app().send(ApplyEdit{SetContours{.id = "c1", .name = "drawn", .curves = curves}});
    driver.settle();
  };
  add();
  driver.app().send(ShowContours{{"c1"}, false});
  driver.settle();
  CHECK(driver.state().look.hidden_contours.contains("c1"));
  driver.app().send(ApplyEdit{RemoveContours{"c1"}});
  driver.settle();
  add();
  CHECK_FALSE(driver.state().look.hidden_contours.contains("c1"));
  driver.app().send(ShowContours{{"c1"}, false});
  driver.app().send(open_phantom(Organ::kidney, 2));
  driver.wait_until("another case is open", [&] { return driver.document().structures.size() == 1; });
  driver.settle();
  CHECK(driver.state().look.hidden_contours.empty());
}

}  // namespace homolog
