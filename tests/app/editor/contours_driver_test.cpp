#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

#include "app/editor/state/views.h"
#include "app/editor/update/controls.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/construction/icosphere.h"
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

TEST_CASE("the mesh that followed a curve stays on the screen until the fit is there") {
  const TemporaryFolder folder;
  Driver driver(ball_document(folder));
  driver.settle();
  const Points start = mesh_of(driver);
  const auto moved_mm = [&] {
    return (*driver.app().snapshot().shown->view()->shape.points - start).rowwise().norm().maxCoeff();
  };
  draw(driver, circle_px(driver, ViewKind::axial, 0));
  driver.wait_until("the mesh follows the curve", [&] { return moved_mm() > 3; });
  driver.button(MouseButton::left, false);
  driver.hold_keys({});
  // The session's thread shows the document for a moment only, before it computes.
  driver.wait_until("the fit is there, or the mesh that followed meanwhile",
                    [&] { return contours_of(driver) == 1 && moved_mm() > 3; });
  driver.settle();
  CHECK(moved_mm() > 3);
  CHECK(driver.app().snapshot().shown == driver.app().snapshot().document);
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
  const int fits = driver.lines_with(R"("by":"contours")");
  driver.click("Fit to contours");
  driver.wait_until("the fit is done", [&] { return driver.lines_with(R"("by":"contours")") == fits + 1; });
  driver.settle();
  CHECK(driver.shows("from the mesh on average"));
  // It is of those contours alone.
  driver.click("c2/remove");
  driver.settle();
  CHECK_FALSE(driver.shows("from the mesh on average"));
  driver.press('Z', {.ctrl = true});
  driver.settle();
  CHECK((mesh_of(driver) - before).rowwise().norm().maxCoeff() > 0.05);
  driver.press('Z', {.ctrl = true});
  driver.settle();
  CHECK(mesh_of(driver) == before);
  CHECK(contours_of(driver) == 2);
}

TEST_CASE("a curve that is drawn after a fit changes the mesh where it lies and nothing of the fit is lost elsewhere") {
  const TemporaryFolder folder;
  Driver driver(ball_document(folder));
  driver.settle();
  // As a fit left it: the organ, with a bump far from the curve to come.
  Points fitted = icosphere(3, radius_mm).points;
  for (Eigen::Index i = 0; i < fitted.rows(); ++i)
    fitted.row(i) *= 1 + 0.3 * std::exp(-(fitted.row(i).transpose() - Vec3(0, 0, radius_mm)).squaredNorm() / 40);
  fitted.rowwise() += middle.transpose();
  driver.app().send(ApplyEdit{SetPoints{FoundBy::fit, std::nullopt, std::make_shared<const Points>(fitted)}});
  driver.settle();
  draw_circle(driver, ViewKind::axial, -16);
  const auto top_mm = [&] { return mesh_of(driver).col(2).maxCoeff() - middle.z(); };
  CHECK(top_mm() == doctest::Approx(1.3 * radius_mm).epsilon(0.02));
  draw_circle(driver, ViewKind::axial, -10);
  CHECK(top_mm() == doctest::Approx(1.3 * radius_mm).epsilon(0.02));
  // The button begins with the template, which has no bump.
  driver.click("Fit to contours");
  driver.wait_until("the template is fitted anew", [&] { return top_mm() < 1.2 * radius_mm; });
}

TEST_CASE("the wheel leaves a curve that is being drawn in its slice") {
  const TemporaryFolder folder;
  Driver driver(ball_document(folder));
  driver.settle();
  const auto px = circle_px(driver, ViewKind::axial, 0);
  driver.press('A');
  driver.move(px[0].x(), px[0].y());
  driver.button(MouseButton::left, true);
  for (std::size_t k = 1; k < px.size(); ++k) {
    driver.move(px[k].x(), px[k].y());
    if (k == px.size() / 2) driver.wheel(3);
  }
  let_go(driver);
  REQUIRE(contours_of(driver) == 1);
  const auto& points = driver.document().structure()->contours.front()->curves.front().points;
  for (const Vec3& p : points) CHECK(p.z() == doctest::Approx(points.front().z()));
  CHECK(points.size() > 20);
}

TEST_CASE("a stroke from a contour back to it draws that part anew and the mesh follows in one step to undo") {
  const TemporaryFolder folder;
  Driver driver(ball_document(folder));
  driver.settle();
  draw_circle(driver, ViewKind::axial, 0);
  const ContourSet before = *driver.document().structure()->contours.front();
  const Points mesh_before = mesh_of(driver);
  // How far the mesh reaches from the organ's middle towards a side, near the slice.
  const auto reach_mm = [](const Points& points, const Vec3& side) {
    return ((points.rowwise() - middle.transpose()) * side).maxCoeff();
  };
  const ViewMap map = view_map(driver.state(), driver.app().layout(), driver.document(), ViewKind::axial);
  const Vec3 side = map.slice().right, down = map.slice().down;
  CHECK(reach_mm(mesh_before, side) == doctest::Approx(radius_mm).epsilon(0.01));

  // Out to 30 mm on the right of the screen, from 30 degrees above to 30 degrees below.
  std::vector<Eigen::Vector2d> bulge;
  for (int k = -20; k <= 20; ++k) {
    const double angle = k * std::numbers::pi / 6 / 20, out = radius_mm + 6 * std::cos(angle * 3);
    bulge.push_back(*map.to_px(middle + out * (std::cos(angle) * side + std::sin(angle) * down)));
  }
  draw(driver, bulge);
  driver.wait_until("the mesh follows the stroke", [&] {
    return reach_mm(*driver.app().snapshot().shown->view()->shape.points, side) > radius_mm + 4;
  });
  CHECK(mesh_of(driver) == mesh_before);
  driver.press(key::escape, {.ctrl = true});
  let_go(driver);
  CHECK(*driver.document().structure()->contours.front() == before);
  CHECK(driver.lines_with(R"("contours":{)") == 1);

  std::reverse(bulge.begin(), bulge.end());  // a second press at one place is a double click
  draw(driver, bulge);
  let_go(driver);
  REQUIRE(contours_of(driver) == 1);
  const ContourSet& after = *driver.document().structure()->contours.front();
  CHECK(after.curves.size() == 1);
  CHECK(after.curves.front().closed);
  CHECK_FALSE(crosses_itself(after.curves.front()));
  CHECK(driver.lines_with(R"("curve":0)") == 1);
  double furthest = 0, other_side = 0, off_plane = 0;
  for (const Vec3& p : after.curves.front().points) {
    furthest = std::max(furthest, side.dot(p - middle));
    other_side = std::max(other_side, -side.dot(p - middle));
    off_plane = std::max(off_plane, std::abs(p.z() - before.curves.front().points.front().z()));
  }
  CHECK(furthest == doctest::Approx(radius_mm + 6).epsilon(0.01));
  CHECK(other_side == doctest::Approx(radius_mm).epsilon(0.01));
  CHECK(off_plane < 1e-9);
  CHECK(reach_mm(mesh_of(driver), side) > radius_mm + 5);
  CHECK(reach_mm(mesh_of(driver), -side) == doctest::Approx(radius_mm).epsilon(0.03));
  const auto again = read_case(driver.case_file());
  REQUIRE(again);
  CHECK(same_document(again->session.document(), driver.document()));

  driver.press('Z', {.ctrl = true});
  driver.settle();
  CHECK(*driver.document().structure()->contours.front() == before);
  CHECK(mesh_of(driver) == mesh_before);
}

TEST_CASE("a small stroke from a contour back to it mends it although its ends are near each other") {
  const TemporaryFolder folder;
  Driver driver(ball_document(folder));
  driver.settle();
  draw_circle(driver, ViewKind::axial, 0);
  const auto around = circle_px(driver, ViewKind::axial, 0);
  const Eigen::Vector2d centre = (around[0] + around[20]) / 2, at = around[10];
  const Eigen::Vector2d out = (at - centre).normalized(), along(-out.y(), out.x());
  std::vector<Eigen::Vector2d> bump;
  for (int k = -10; k <= 10; ++k) bump.emplace_back(at + 0.6 * k * along + (100 - k * k) * 0.2 * out);
  draw(driver, bump);
  let_go(driver);
  REQUIRE(contours_of(driver) == 1);
  const auto& points = driver.document().structure()->contours.front()->curves.front().points;
  double farthest_mm = 0;
  for (const Vec3& p : points) farthest_mm = std::max(farthest_mm, (p - middle).norm());
  CHECK(farthest_mm > radius_mm + 1);
}

TEST_CASE("a stroke beside a contour or in another slice leaves it and the list closes and opens a curve") {
  const TemporaryFolder folder;
  Driver driver(ball_document(folder));
  driver.settle();
  draw_circle(driver, ViewKind::axial, 0);
  const ContourSet before = *driver.document().structure()->contours.front();
  // From the contour to its middle: a curve of its own.
  const auto around = circle_px(driver, ViewKind::axial, 0);
  const Eigen::Vector2d centre = (around[0] + around[20]) / 2;
  std::vector<Eigen::Vector2d> inward;
  for (int k = 0; k <= 20; ++k) inward.emplace_back(around[10] + k / 20.0 * (centre - around[10]));
  draw(driver, inward);
  let_go(driver);
  CHECK(contours_of(driver) == 2);
  CHECK(*driver.document().structure()->contours.front() == before);
  CHECK(driver.lines_with(R"("curve":)") == 0);

  const auto curve = [&](const char* id) { return driver.document().structure()->contour_set(id)->curves.front(); };
  driver.click("c2/closed");
  driver.settle();
  CHECK(curve("c2").closed);
  CHECK(driver.lines_with(R"("curve":0)") == 1);
  driver.press('Z', {.ctrl = true});
  driver.settle();
  CHECK_FALSE(curve("c2").closed);
  driver.click("c1/closed");
  driver.settle();
  CHECK_FALSE(curve("c1").closed);
  CHECK(curve("c1").points == before.curves.front().points);

  // In another slice the same stroke touches nothing.
  const auto higher = circle_px(driver, ViewKind::axial, 6);
  draw(driver, {higher.begin(), higher.begin() + 12});
  let_go(driver);
  CHECK(contours_of(driver) == 3);
  CHECK(curve("c1").points == before.curves.front().points);
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

TEST_CASE("of a file with several structures one chooses those to add") {
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
