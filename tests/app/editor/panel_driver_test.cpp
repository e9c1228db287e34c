#include <doctest/doctest.h>

#include "app/editor/scene/mesh_colouring.h"
#include "core/mesh/icosphere.h"
#include "core/mesh/label_map.h"
#include "core/volume/volume_io.h"
#include "tests/ball.h"
#include "tests/driver.h"
#include "tests/must.h"
#include "tests/organ_scan.h"

// What lies in the side panel stays where a person saw it, and what is opened is seen.

namespace homolog {

namespace {

/// Where the panel's controls and texts are, by their paths.
std::map<std::string, float> places(const Driver& driver) {
  std::map<std::string, float> all;
  for (const DrawnItem& item : driver.items())
    if (item.is_control() && item.path.starts_with("side panel")) all[item.path] = item.rect.y;
  return all;
}

}  // namespace

TEST_CASE("nothing in the panel moves when a label map is opened or closed or fitted to") {
  const TemporaryFolder folder;
  VolumeGeometry grid;
  grid.dims = {50, 50, 50};
  grid.spacing_mm.setConstant(1.6);
  grid.origin_mm.setConstant(-40);
  Volume labels = label_map(icosphere(3, 24), grid, 1);
  std::get<std::vector<std::uint8_t>>(labels.data)[0] = 2;  // two labels to choose from
  const auto file = folder.path / "label.nii.gz";
  REQUIRE(write_volume(labels, file));
  Driver driver(new_document("", std::make_shared<const Volume>(labels), ball_template(20)), {1280, 2400, 1});
  for (const char* section : {"Template", "Place", "Export"}) driver.app().send(OpenSection{section, true});
  driver.settle();
  const auto before = places(driver);
  const auto moved = [&] {
    std::string paths;
    const auto now = places(driver);
    for (const auto& [path, y] : before)
      if (const auto found = now.find(path); found != now.end() && found->second != y) paths += "\n  " + path;
    return paths;
  };
  driver.app().send(open_labels(file));
  driver.wait_until("the label map is open", [&] { return driver.has("Place/Fit to the label"); });
  driver.settle();
  CHECK(moved() == "");
  driver.app().send(StartFit{driver.state().fit_settings});
  driver.wait_until("the fit runs or is done", [&] { return driver.has("Place/Cancel") || driver.shows("Dice"); });
  CHECK(moved() == "");
  driver.wait_until("the fit is done", [&] { return driver.shows("Dice"); });
  driver.settle();
  CHECK(moved() == "");
  driver.app().send(CloseLabels{});
  driver.settle();
  CHECK(moved() == "");
}

TEST_CASE("the doubt of a fit is an overlay with a legend and a figure") {
  VolumeGeometry grid;
  grid.dims = {50, 50, 50};
  grid.spacing_mm.setConstant(1.6);
  grid.origin_mm.setConstant(-40);
  const TemporaryFolder folder;
  const Volume labels = label_map(icosphere(3, 24), grid, 1);
  const auto file = folder.path / "label.nii.gz";
  REQUIRE(write_volume(labels, file));
  Driver driver(new_document("", std::make_shared<const Volume>(labels), ball_template(20)), {1280, 3600, 1});
  for (const char* section : {"Place", "Correspondence"}) driver.app().send(OpenSection{section, true});
  driver.app().send(open_labels(file));
  driver.wait_until("the label map is open", [&] { return driver.has("Place/Fit to the label"); });
  driver.click("Correspondence/overlay/Doubt");
  driver.settle();
  CHECK(driver.shows("not known: fit the mesh to a label map first"));

  driver.click("Place/Fit to the label");
  driver.wait_until("the fit is done", [&] { return driver.shows("Dice"); });
  driver.settle();
  CHECK_FALSE(driver.shows("not known: fit the mesh to a label map first"));
  driver.wait_until("the figure is there", [&] { return driver.shows(" mm, at most 1"); });
  CHECK(driver.state().colouring == Colouring::doubt);
  const Document& document = driver.document();
  REQUIRE(document.shape().doubt_mm);
  const auto colours = mesh_colours(document, Colouring::doubt, {}, 1);
  CHECK(colouring_legend(document, Colouring::doubt).high == "2 mm");
  CHECK(std::any_of(colours.begin(), colours.end(), [&](const Rgb& one) { return one != colours.front(); }));
}

TEST_CASE("a section that is opened at the panel's end is scrolled into view") {
  Driver driver(new_document("", nullptr, ball_template(20)), {1024, 700, 1});
  REQUIRE(driver.control("side panel/Export").value == "off");
  driver.click("side panel/Export");
  driver.settle();
  for (const char* name : {"side panel/Export", "Export/Mesh…", "Export/Save the picture…"}) {
    const DrawnItem& item = driver.control(name);
    CHECK_MESSAGE(item.seen.height == item.rect.height, name, " is not in view");
  }
  // One that has room stays where it is.
  driver.click("side panel/Export");
  driver.wheel(100);
  driver.settle();
  const float at = driver.control("side panel/Case").rect.y;
  driver.click("side panel/Case");
  driver.settle();
  driver.click("side panel/Case");
  driver.settle();
  CHECK(driver.control("side panel/Case").rect.y == at);
}

TEST_CASE("a folded section says what is in it") {
  const OrganScan scan;
  Driver driver(scan.document(), {1280, 2400, 1});
  REQUIRE(driver.control("side panel/Place").value == "off");
  CHECK(driver.shows("0 of 3 landmarks"));
  driver.click("side panel/Place");
  CHECK_FALSE(driver.shows("0 of 3 landmarks"));
  if (driver.control("side panel/Template").value == "on") driver.click("side panel/Template");
  CHECK(driver.shows("organ.ply"));
}

}  // namespace homolog
