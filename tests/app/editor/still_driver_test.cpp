#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <string>

#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/volume/volume_io.h"
#include "tests/beating_ball.h"
#include "tests/driver.h"
#include "tests/must.h"
#include "tests/organ_scan.h"

// While work runs, and when it ends, nothing moves away from under the pointer.

namespace homolog {

namespace {

using Rects = std::map<std::string, RectPx>;

Rects rects_of(const Driver& driver) {
  Rects rects;
  for (const DrawnItem& item : driver.items())
    if (item.is_control() && item.path.starts_with("side panel/")) rects[item.path] = item.rect;
  return rects;
}

/// Which controls are elsewhere than before; those that came or went do not count.
std::string moved_since(const Rects& before, const Driver& driver, float above_px = 1e9f) {
  std::string moved;
  for (const auto& [path, rect] : rects_of(driver)) {
    const auto was = before.find(path);
    if (was == before.end() || was->second.y > above_px) continue;
    if (std::abs(was->second.y - rect.y) > 0.5f || std::abs(was->second.x - rect.x) > 0.5f)
      moved += path + " from " + std::to_string(was->second.y) + " to " + std::to_string(rect.y) + "\n";
  }
  return moved;
}

/// Presses a button and looks at every frame while `busy`; returns what moved, and how many frames there were.
struct Watched {
  std::string moved;
  int frames = 0;
};
Watched watch(Driver& driver, const char* start, const std::function<bool()>& busy, float above_px = 1e9f) {
  driver.point_at(start);
  const Rects before = rects_of(driver);
  driver.button(MouseButton::left, true);
  driver.button(MouseButton::left, false);
  Watched watched;
  int at_rest = 0;
  for (int k = 0; k < 5000 && at_rest < 3; ++k) {
    driver.frame();
    watched.moved = moved_since(before, driver, above_px);
    if (!watched.moved.empty()) break;
    watched.frames += busy() ? 1 : 0;
    at_rest = busy() ? 0 : at_rest + 1;
  }
  driver.settle();
  return watched;
}

constexpr std::array<Driver::Size, 2> window_sizes{{{1280, 1400, 1}, {800, 600, 1}}};

}  // namespace

TEST_CASE("no control of the panel moves while a cine is propagated") {
  for (const Driver::Size& size : window_sizes) {
    CAPTURE(size.width_px);
    Driver driver(BeatingBall::document(), size);
    const Watched watched = watch(driver, "Cine/Propagate", [&] { return driver.app().busy(); });
    CHECK(watched.moved == "");
    CHECK(watched.frames > 0);
    // Whatever the sentence below the button says, one line or two.
    const Rects before = rects_of(driver);
    for (int frame = 1; frame < BeatingBall::frames; ++frame) {
      driver.app().send(ShowFrame{frame});
      driver.settle();
      Stroke pull;
      pull.at = driver.document().view()->shape.points->row(0);
      pull.to = 1.05 * pull.at;
      pull.sigma_mm = 12;
      driver.app().send(ApplyEdit{pull});
      driver.settle();
      const RectPx button = driver.control("Cine/Propagate").rect;
      CHECK(button == before.at("side panel/Cine/Propagate"));
      CHECK(driver.control("Cine/volume curve").rect.y == before.at("side panel/Cine/volume curve").y);
    }
  }
}

TEST_CASE("no control of the panel moves while a fit or a refinement or a snap runs") {
  const OrganScan scan;
  REQUIRE(write_volume(label_map(icosphere(4, 21), OrganScan::grid(), 1), scan.folder.path / "labels.nii"));
  for (const Driver::Size& size : window_sizes) {
    CAPTURE(size.width_px);
    Driver driver(scan.document(), size);
    driver.app().send(OpenSection{"Place", true});
    driver.frames(3);
    driver.app().send(open_labels(scan.folder.path / "labels.nii"));
    driver.wait_until("the map is open", [&] {
      return driver.has("Place/Fit to the label") && driver.control("Place/Fit to the label").enabled;
    });
    for (const std::string start : {"Place/Fit to the label", "Refine along the surface", "Snap/Snap the whole mesh"}) {
      CAPTURE(start);
      const Watched watched = watch(driver, start.c_str(), [&] { return driver.app().busy(); });
      CHECK(watched.moved == "");
    }
    CHECK(driver.shows("The smallest angle was"));
  }
}

TEST_CASE("a map that is opened puts no other button in the place of the one that opens it") {
  const OrganScan scan;
  REQUIRE(write_volume(label_map(icosphere(4, 21), OrganScan::grid(), 1), scan.folder.path / "labels.nii"));
  for (const Driver::Size& size : window_sizes) {
    Driver driver(scan.document(), size);
    for (const char* section : {"Template", "Place"}) driver.app().send(OpenSection{section, true});
    driver.frames(3);
    driver.point_at("Template/Open a label map…");
    const Rects before = rects_of(driver);
    driver.app().send(open_labels(scan.folder.path / "labels.nii"));
    driver.wait_until("the map is open", [&] {
      return driver.has("Template/Make the template") && driver.control("Template/Make the template").enabled;
    });
    CHECK(moved_since(before, driver) == "");
    CHECK(driver.control("Template/Open a label map…").hovered);
  }
}

TEST_CASE("while a template is made and when it is taken what the pointer is on stays there") {
  const OrganScan scan;
  REQUIRE(write_volume(label_map(icosphere(4, 21), OrganScan::grid(), 1), scan.folder.path / "labels.nii"));
  for (const Driver::Size& size : window_sizes) {
    CAPTURE(size.width_px);
    Driver driver(scan.document(), size);
    driver.app().send(OpenSection{"Template", true});
    driver.frames(3);
    driver.app().send(open_labels(scan.folder.path / "labels.nii"));
    driver.wait_until("the map is open", [&] {
      return driver.has("Template/Make the template") && driver.control("Template/Make the template").enabled;
    });
    driver.point_at("Template/Make the template");
    const float button_px = driver.control("Template/Make the template").rect.y;
    const Watched watched = watch(
        driver, "Template/Make the template", [&] { return driver.app().busy(); }, button_px + 1);
    CHECK(watched.moved == "");
    REQUIRE(driver.has("Template/Save and use…"));
    // Somebody has gone on to a section below meanwhile.
    driver.click("Template/Close");
    driver.settle();
    driver.point_at("Deform");
    const float deform_px = driver.control("side panel/Deform").rect.y;
    driver.app().send(MakeTemplate{driver.state().automatic.template_settings, std::nullopt});
    driver.wait_until("it is made", [&] { return driver.has("Template/Save and use…"); });
    CHECK(driver.control("side panel/Deform").rect.y == doctest::Approx(deform_px).epsilon(0.01));
    driver.app().send(CloseTemplateMaking{});
    driver.settle();
    CHECK_FALSE(driver.has("Template/Save and use…"));
    CHECK(driver.control("side panel/Deform").rect.y == doctest::Approx(deform_px).epsilon(0.01));
  }
}

TEST_CASE("a new notice moves none of those that are there and covers nothing that runs") {
  Driver driver(OrganScan().document());
  add_notice(driver.state(), "The first sentence.");
  driver.frames(3);
  const RectPx first = driver.control("notice 0/dismiss").rect;
  add_notice(driver.state(), "The second sentence.");
  driver.frames(3);
  CHECK(driver.control("notice 0/dismiss").rect == first);
}

}  // namespace homolog
