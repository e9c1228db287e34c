#include <doctest/doctest.h>

#include <cctype>
#include <fstream>
#include <string>

#include "app/editor/update/tools/tool.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/voxels/label_map.h"
#include "core/volume/volume_io.h"
#include "tests/driver.h"
#include "tests/must.h"
#include "tests/organ_scan.h"

// Clicks and keys that must not do what they were not meant for: double clicks, and letters typed into an open list.

namespace homolog {

namespace {

/// A px of a view where the tool in hand finds something: on the outline of the mesh, or in the middle of the surface.
Eigen::Vector2d on_mesh(Driver& driver, ViewKind kind) {
  const ViewMap map = view_map(driver.state(), driver.app().layout(), driver.document(), kind);
  if (!map.is_slice()) return *map.to_px(bounds_of(*driver.document().view()->shape.points).center());
  const Eigen::Vector2d middle = *map.to_px(driver.state().look.crosshair_mm);
  for (double x = middle.x(); x > driver.app().layout().image(kind).x; x -= 1) {
    driver.move(x, middle.y());
    if (driver.state().pointer.hover && driver.state().pointer.hover->on_mesh) return {x, middle.y()};
  }
  FAIL("the cross-hair's row does not meet the outline");
  return middle;
}

/// Presses so many times within the time of a double click; each but the first a little beside the one before.
void press_at_once(Driver& driver, const Eigen::Vector2d& px, int times) {
  driver.settle();
  for (int k = 0; k < 70; ++k) driver.frame();  // no press before belongs to these
  for (int k = 0; k < times; ++k) {
    driver.move(px.x() + k % 2, px.y());
    driver.button(MouseButton::left, true);
    driver.button(MouseButton::left, false);
  }
}

std::string text_of_case(Driver& driver) {
  std::string text;
  std::ifstream file(driver.case_file());
  for (std::string line; std::getline(file, line);)
    if (line.find("\"look\"") == std::string::npos) text += line + '\n';
  return text;
}

}  // namespace

TEST_CASE("a double click enlarges a view and edits nothing with any tool in any view") {
  const OrganScan scan;
  for (const bool maximised : {false, true})
    for (const ViewKind view : {ViewKind::axial, ViewKind::space}) {
      Driver driver(scan.document(), {maximised ? 800 : 1280, maximised ? 600 : 800, 1});
      driver.app().send(ApplyEdit{SetLandmarkPull{LandmarkPull::warp}, false});
      driver.settle();
      if (maximised) driver.state().look.maximised = view;
      driver.frames(3);
      for (const ToolKind* kind : tool_kinds)
        for (const int clicks : {2, 3, 4}) {
          CAPTURE(kind->name);
          CAPTURE(clicks);
          if (maximised && clicks == 4) continue;  // the third meets whatever lies there of the four views
          driver.app().send(ChooseTool{kind->tool});
          driver.state().hand.template_landmark = "new one";
          driver.state().look.maximised = maximised ? std::optional(view) : std::nullopt;
          driver.state().hand.ruler = Ruler{Vec3(0, 0, 0), Vec3(10, 0, 0)};
          driver.frames(3);
          const std::string before = text_of_case(driver);
          const Camera3D camera = driver.state().look.camera;
          press_at_once(driver, on_mesh(driver, view), clicks);
          CHECK((driver.state().look.maximised != std::nullopt) == (maximised == (clicks == 4)));
          driver.settle();
          CHECK(text_of_case(driver) == before);
          driver.wait_until("the preview is gone", [&] { return !driver.app().snapshot().preview; });
          CHECK(driver.state().hand.tool == kind->tool);
          REQUIRE(driver.state().hand.ruler);
          CHECK(driver.state().hand.ruler->length_mm() == 10);
          CHECK(driver.state().look.camera.to_eye == camera.to_eye);
          CHECK(driver.state().notices.empty());
        }
    }
}

TEST_CASE("a single click still does what it is for and two quick ones at two places do both") {
  const OrganScan scan;
  Driver driver(scan.document());
  driver.app().send(ApplyEdit{SetLandmarkPull{LandmarkPull::off}, false});
  driver.press('L');
  const Eigen::Vector2d at = on_mesh(driver, ViewKind::axial);
  press_at_once(driver, at, 1);
  CHECK(driver.document().view()->shape.landmarks.empty());  // another press could still make it a double click
  driver.settle();
  CHECK(driver.document().view()->shape.landmarks.size() == 1);
  driver.move(at.x() + 30, at.y());
  driver.button(MouseButton::left, true);
  driver.button(MouseButton::left, false);
  driver.move(at.x() + 60, at.y() + 10);
  driver.button(MouseButton::left, true);
  driver.button(MouseButton::left, false);
  driver.settle();
  CHECK(driver.document().view()->shape.landmarks.size() == 3);
  CHECK_FALSE(driver.state().look.maximised);
  // A key right after a click comes after it.
  press_at_once(driver, at + Eigen::Vector2d(5, 5), 0);
  driver.press('B');
  driver.move(at.x(), at.y());
  driver.button(MouseButton::left, true);
  driver.button(MouseButton::left, false);
  driver.press('Z', {false, true, false});
  driver.settle();
  CHECK(driver.lines_with("\"stiffness\"") == 1);
  CHECK(driver.lines_with("\"undo\"") == 1);
}

TEST_CASE("a brush that is held still paints without waiting for the pointer") {
  const OrganScan scan;
  Driver driver(scan.document());
  driver.press('C');
  on_mesh(driver, ViewKind::axial);
  driver.settle();
  driver.frames(70);
  driver.button(MouseButton::left, true);
  driver.frames(30);
  driver.wait_until("it has painted", [&] { return driver.lines_with("\"confirm\"") == 1; });
  driver.button(MouseButton::left, false);
  driver.settle();
  CHECK(driver.lines_with("\"confirm\"") == 1);
}

TEST_CASE("what is typed into an open list searches it and does nothing behind it") {
  const OrganScan scan;
  Driver driver(scan.document());
  Volume map = *OrganScan::image();
  std::vector<std::uint16_t> values(map.geometry.voxels(), 0);
  for (std::size_t k = 0; k < 90; ++k)
    for (std::size_t v = 0; v < 64; ++v) values[(k * 64 + v)] = static_cast<std::uint16_t>(k + 1);
  map.data = std::move(values);
  map.range_min = 0;
  map.range_max = 90;
  REQUIRE(write_volume(map, driver.folder() / "labels.nii"));
  driver.app().send(OpenSection{"Place", true});
  driver.app().send(open_labels(driver.folder() / "labels.nii"));
  driver.frames(3);
  driver.wait_until("the map is open", [&] { return driver.control("Place/label").value != "No label map is open"; });
  driver.settle();  // its name is in the case
  const auto type_letters = [&](std::string_view text) {
    for (const char letter : text) {
      driver.press(std::toupper(letter));  // as the window system sends both
      driver.type(std::string_view(&letter, 1));
    }
  };
  const MouseTool tool = driver.state().hand.tool;
  const std::string before = text_of_case(driver);
  const ShownParts parts = driver.state().preferences.show;
  driver.click("Place/label");
  REQUIRE(driver.has("label/Label 1"));
  type_letters("nsblgrc dmktxof123");
  for (const int code : {key::f1, key::page_up, key::del}) driver.press(code);
  for (const int letter : {'S', 'Z', 'O', 'Q'}) driver.press(letter, {false, true, false});
  driver.settle();
  CHECK(driver.state().hand.tool == tool);
  CHECK(text_of_case(driver) == before);
  CHECK(driver.state().preferences.show == parts);
  CHECK_FALSE(driver.state().dialog);
  CHECK_FALSE(driver.has("label/Label 1"));  // none is called so
  for (int k = 0; k < 20; ++k) driver.press(key::backspace);
  CHECK(driver.has("label/Label 1"));
  type_letters("label 77");
  CHECK(driver.shows("Search: label 77"));
  CHECK(driver.has("label/Label 77"));
  CHECK_FALSE(driver.has("label/Label 7"));
  driver.press(key::enter);
  driver.settle();
  CHECK(driver.control("Place/label").value == "Label 77");
  CHECK_FALSE(driver.has("label/Label 77"));
  // Escape closes the list, and nothing else.
  driver.state().hand.ruler = Ruler{Vec3(0, 0, 0), Vec3(10, 0, 0)};
  driver.click("Place/label");
  type_letters("9");
  driver.press(key::escape);
  CHECK_FALSE(driver.has("label/Label 9"));
  CHECK(driver.state().hand.ruler);
  CHECK(driver.control("Place/label").value == "Label 77");
}

TEST_CASE("a menu is searched likewise and a click beside it in a view edits nothing") {
  const OrganScan scan;
  Driver driver(scan.document());
  driver.app().send(ApplyEdit{SetStiffnessBase{5}, false});
  driver.app().send(ApplyEdit{SetEvenSpacing{0.5}, false});
  driver.settle();
  driver.press('L');
  const Eigen::Vector2d at = on_mesh(driver, ViewKind::coronal);
  driver.click("history");
  REQUIRE(driver.has("history/Undo: stiffness"));
  for (const char letter : std::string("SPAC")) {
    driver.press(letter);
    driver.type(std::string(1, static_cast<char>(std::tolower(letter))));
  }
  CHECK(driver.has("history/Undo: even spacing"));
  CHECK_FALSE(driver.has("history/Undo: stiffness"));
  CHECK(driver.state().hand.tool == MouseTool::landmark);
  driver.move(at.x(), at.y());
  driver.button(MouseButton::left, true);
  driver.button(MouseButton::left, false);
  driver.settle();
  CHECK_FALSE(driver.has("history/Undo: even spacing"));
  CHECK(driver.document().view()->shape.landmarks.empty());
  driver.click("history");
  driver.press('S');
  driver.type("spac");
  driver.press(key::enter);
  driver.settle();
  CHECK(driver.document().even_spacing != 0.5);
  CHECK(driver.document().structure()->paint.base == 5);
}

}  // namespace homolog
