#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

#include "app/editor/update/controls.h"
#include "core/mesh/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/session/case_file.h"
#include "core/session/checkpoint.h"
#include "tests/driver.h"
#include "tests/must.h"

// Contours in the window: drawn, listed, opened from files, and the mesh that goes to them.

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// The organ: a ball that is larger than the template's 20 mm and lies aside.
const Vec3 middle(2, -1, 1.5);
constexpr double radius_mm = 24;

double off_organ_mm(const Points& points) {
  return ((points.rowwise() - middle.transpose()).rowwise().norm().array() - radius_mm).abs().mean();
}

Document ball_document(const TemporaryFolder& folder) {
  const Mesh ball = icosphere(3, 20);
  REQUIRE(write_mesh_file(MeshFile{ball.points, ball.topology->triangles()}, folder.path / "ball.ply"));
  return new_document("", nullptr, test::must(load_template((folder.path / "ball.ply").string())));
}

const Points& mesh_of(const Driver& driver) {
  return *driver.document().view()->shape.points;
}

std::size_t contours_of(const Driver& driver) {
  return driver.document().structure()->contours.size();
}

/// Puts the cross-hair so that a slice view cuts the organ at `along` mm from its middle, and gives the px around its
/// section there.
std::vector<Eigen::Vector2d> circle_px(Driver& driver, ViewKind kind, double along_mm) {
  const Vec3 normal = slice_view(driver.state(), kind, geometry_of(driver.document())).normal();
  const Vec3 centre = middle + along_mm * normal;
  driver.state().look.crosshair_mm = centre;
  driver.settle();
  const ViewMap map = view_map(driver.state(), driver.app().layout(), driver.document(), kind);
  const double r = std::sqrt(radius_mm * radius_mm - along_mm * along_mm);
  std::vector<Eigen::Vector2d> px;
  for (int k = 0; k <= 40; ++k) {
    const double angle = 2 * std::numbers::pi * k / 40;
    px.push_back(*map.to_px(centre + r * (std::cos(angle) * map.slice().right + std::sin(angle) * map.slice().down)));
  }
  return px;
}

/// Draws with Ctrl held, up to the last `left` points, and stays there.
void draw(Driver& driver, const std::vector<Eigen::Vector2d>& px, std::size_t left = 0) {
  driver.move(px.front().x(), px.front().y());
  driver.hold_keys({.ctrl = true});
  driver.button(MouseButton::left, true);
  for (std::size_t k = 1; k + left < px.size(); ++k) driver.move(px[k].x(), px[k].y());
}

void let_go(Driver& driver) {
  driver.button(MouseButton::left, false);
  driver.hold_keys({});
  driver.settle();
}

void draw_circle(Driver& driver, ViewKind kind, double along_mm) {
  draw(driver, circle_px(driver, kind, along_mm));
  let_go(driver);
}

}  // namespace

TEST_CASE("five drawn circles carry the mesh to the organ and each is one step to undo") {
  const TemporaryFolder folder;
  Driver driver(ball_document(folder));
  driver.settle();
  const Points start = mesh_of(driver);
  CHECK(off_organ_mm(start) > 3.5);

  draw_circle(driver, ViewKind::axial, 0);
  REQUIRE(contours_of(driver) == 1);
  const ContourSet& first = *driver.document().structure()->contours.front();
  CHECK(first.name == "Contour 1");
  REQUIRE(first.curves.size() == 1);
  CHECK(first.curves.front().closed);
  for (const Vec3& p : first.curves.front().points)
    CHECK((p - middle).norm() == doctest::Approx(radius_mm).epsilon(0.02));
  CHECK(driver.shows("Contour 1"));
  const double after_one_mm = off_organ_mm(mesh_of(driver));
  CHECK(after_one_mm < 2.5);

  draw_circle(driver, ViewKind::axial, 14);
  draw_circle(driver, ViewKind::axial, -14);
  draw_circle(driver, ViewKind::sagittal, 0);
  const Points of_four = mesh_of(driver);
  draw_circle(driver, ViewKind::coronal, 0);
  CHECK(contours_of(driver) == 5);
  const Points of_five = mesh_of(driver);
  CHECK(off_organ_mm(of_five) < 0.25);

  // Each curve and what the mesh did for it come back together.
  driver.press('Z', {.ctrl = true});
  driver.settle();
  CHECK(contours_of(driver) == 4);
  CHECK(mesh_of(driver) == of_four);
  driver.press('Y', {.ctrl = true});
  driver.settle();
  CHECK(mesh_of(driver) == of_five);
  const auto again = read_case(driver.case_file());
  REQUIRE(again);
  CHECK(same_document(again->session.document(), driver.document()));
  for (int k = 0; k < 5; ++k) {
    driver.press('Z', {.ctrl = true});
    driver.settle();
  }
  CHECK(contours_of(driver) == 0);
  CHECK(mesh_of(driver) == start);
}

TEST_CASE("the mesh follows while a curve is drawn and Escape gives it up") {
  const TemporaryFolder folder;
  Driver driver(ball_document(folder));
  driver.settle();
  const Points start = mesh_of(driver);
  draw(driver, circle_px(driver, ViewKind::axial, 0), 8);
  driver.wait_until("the mesh follows the curve", [&] {
    const Points& shown = *driver.app().snapshot().shown->view()->shape.points;
    return (shown - start).rowwise().norm().maxCoeff() > 3;
  });
  CHECK(mesh_of(driver) == start);
  driver.press(key::escape, {.ctrl = true});
  let_go(driver);
  driver.wait_until("the mesh is as before",
                    [&] { return *driver.app().snapshot().shown->view()->shape.points == start; });
  CHECK(contours_of(driver) == 0);
  CHECK(driver.lines_with("contours") == 0);

  // A click with Ctrl draws nothing, and a curve that ends elsewhere stays open.
  auto px = circle_px(driver, ViewKind::axial, 0);
  draw(driver, {px[0], px[0]});
  let_go(driver);
  CHECK(contours_of(driver) == 0);
  std::rotate(px.begin(), px.begin() + 10, px.end());  // a second press at one place is a double click
  draw(driver, px, 12);
  let_go(driver);
  REQUIRE(contours_of(driver) == 1);
  CHECK_FALSE(driver.document().structure()->contours.front()->curves.front().closed);
  CHECK(driver.lines_with(R"("closed":false)") == 1);
}

TEST_CASE("the list of contours says how far to trust each and what side it is of") {
  const TemporaryFolder folder;
  Driver driver(ball_document(folder));
  draw_circle(driver, ViewKind::axial, 0);
  draw_circle(driver, ViewKind::axial, 10);
  const auto set = [&](const char* id) { return driver.document().structure()->contour_set(id); };

  driver.click("c1/side/Outside");
  driver.settle();
  CHECK(set("c1")->outside);
  CHECK_FALSE(set("c2")->outside);
  CHECK(driver.lines_with(R"({"contours":{"id":"c1","side":"outside"}})") == 1);
  driver.type_into("c2/off", "1.5");
  driver.press(key::enter);
  driver.settle();
  CHECK(set("c2")->off_mm == 1.5);
  driver.click("c2/eye");
  CHECK(driver.state().look.hidden_contours.contains("c2"));
  driver.click("c1/remove");
  driver.settle();
  CHECK(set("c1") == nullptr);
  driver.press('Z', {.ctrl = true});
  driver.settle();
  CHECK(set("c1")->outside);

  // The button fits anew, in one step.
  const Points before = mesh_of(driver);
  const int fits = driver.lines_with(R"("by":"fit")");
  driver.click("Fit to contours");
  driver.wait_until("the fit is done", [&] { return driver.lines_with(R"("by":"fit")") == fits + 1; });
  driver.settle();
  CHECK(driver.shows("from the mesh on average"));
  CHECK((mesh_of(driver) - before).rowwise().norm().maxCoeff() > 0.05);
  driver.press('Z', {.ctrl = true});
  driver.settle();
  CHECK(mesh_of(driver) == before);
  CHECK(contours_of(driver) == 2);
}

TEST_CASE("curves of 3D Slicer come into the case as they are opened and landmarks among them stay landmarks") {
  const TemporaryFolder folder;
  Driver driver(ball_document(folder));
  driver.settle();
  const fs::path file = folder.path / "left kidney.mrk.json";
  {
    std::ofstream out(file);
    out << R"({"markups":[{"type":"ClosedCurve","coordinateSystem":"LPS","controlPoints":[)";
    for (int k = 0; k < 12; ++k) {
      const double angle = 2 * std::numbers::pi * k / 12;
      out << (k > 0 ? "," : "") << R"({"id":")" << k << R"(","label":"p","position":[)" << 22 * std::cos(angle) << ","
          << 22 * std::sin(angle) << ",0]}";
    }
    out << "]}]}";
  }
  driver.app().send(OpenFiles{{file}});
  driver.wait_until("the contours are in the case", [&] { return contours_of(driver) == 1; });
  driver.settle();
  CHECK(driver.document().structure()->contours.front()->name == "left kidney");
  CHECK(driver.document().structure()->contours.front()->curves.front().points.size() == 96);
  CHECK(driver.shows("left kidney"));
  driver.click("Fit to contours");
  driver.wait_until("the mesh went there", [&] { return bounds_of(mesh_of(driver)).max().x() > 21.5; });
  CHECK(bounds_of(mesh_of(driver)).max().x() < 22.5);
}

TEST_CASE("of a file with several structures one chooses and names of the case's structures are known") {
  const TemporaryFolder folder;
  Driver driver(ball_document(folder));
  driver.settle();
  Contours read;
  for (const char* name : {"spleen", "aorta"}) {
    ContourRoi roi{.name = name, .number = static_cast<int>(read.rois.size()) + 1, .type = {}};
    roi.contours.push_back({{Vec3(20, 0, 0), Vec3(0, 20, 0), Vec3(-20, 0, 0), Vec3(0, -20, 0)}});
    read.rois.push_back(roi);
  }
  driver.state().automatic.offered = {"rt.dcm", std::make_shared<const Contours>(read)};
  driver.settle();
  CHECK(driver.shows("In rt.dcm"));
  driver.click("aorta/aorta");
  driver.settle();
  REQUIRE(contours_of(driver) == 1);
  CHECK(driver.document().structure()->contours.front()->name == "aorta");
  driver.click("Close this list");
  driver.settle();
  CHECK_FALSE(driver.shows("In rt.dcm"));
  CHECK(contours_of(driver) == 1);
}

TEST_CASE("confirmed vertices stop a fit to contours with a sentence and the curve stays") {
  const TemporaryFolder folder;
  Driver driver(ball_document(folder));
  driver.settle();
  driver.app().send(ApplyEdit{Confirm{Vec3(0, 0, 20), 5, true}});
  driver.settle();
  const Points before = mesh_of(driver);
  draw_circle(driver, ViewKind::axial, 0);
  CHECK(contours_of(driver) == 1);
  CHECK(mesh_of(driver) == before);
  CHECK(driver.shows("some are confirmed"));
}

}  // namespace homolog
