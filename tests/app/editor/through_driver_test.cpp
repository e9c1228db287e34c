#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "app/editor/state/view_geometry.h"
#include "core/mesh/construction/icosphere.h"
#include "tests/beating_ball.h"
#include "tests/changed_shape.h"
#include "tests/driver.h"
#include "tests/must.h"

// What is said at the pointer while the outline is in hand.

namespace homolog {

namespace {

constexpr double half_thickness_mm = 7.5;
constexpr const char* through = "passes through the opposite wall";

/// A disc across the front and the back of a small image.
Document disc_document() {
  const Mesh ball = icosphere(4, 25);
  Points disc = ball.points;
  disc.col(1) *= half_thickness_mm / 25;
  Document document = new_document("disc", std::make_shared<const Volume>(BeatingBall::cine()),
                                   test::must(make_template({disc, ball.topology->triangles()}, "disc.ply")));
  Shape& shape = test::changed_shape(document);
  shape.placement = shape.before_landmarks = {};
  shape.placed = shape.reference = shape.points = std::make_shared<const Points>(disc);
  return document;
}

const DrawnItem* note(const Driver& driver, std::string_view words) {
  const auto found = std::find_if(driver.items().begin(), driver.items().end(), [&](const DrawnItem& item) {
    return item.kind == DrawnItem::Kind::text && item.name.find(words) != std::string::npos;
  });
  return found == driver.items().end() ? nullptr : &*found;
}

/// Takes hold of the disc's front in the axial slice, and pulls it that far towards the back, one way after the other.
void pull_wall(Driver& driver, const std::vector<double>& ways_mm, const std::function<void(double)>& look) {
  driver.app().send(SetSigma{4});
  driver.app().send(LookAt{Vec3(0, 0, 0)});
  driver.settle();
  const Vec3 front(0, -half_thickness_mm, 0);
  const ViewMap map = view_map(driver.state(), driver.app().layout(), driver.document(), ViewKind::axial);
  const auto move_to = [&](const Vec3& p_mm) {
    const Eigen::Vector2d at = map.to_px(p_mm).value();
    driver.move(at.x(), at.y());
  };
  move_to(front);
  driver.button(MouseButton::left, true);
  for (const double way_mm : ways_mm) {
    move_to(front + Vec3(0, way_mm, 0));
    driver.wait_until("the wall has followed the pointer", [&] {
      const auto& preview = driver.app().snapshot().preview;
      return preview && std::abs(preview->moved_mm - way_mm) < 0.5;
    });
    driver.settle();
    look(way_mm);
  }
}

}  // namespace

TEST_CASE("a wall that is pulled through the opposite one is said at the pointer until it is drawn back") {
  Driver driver(disc_document());
  pull_wall(driver, {3, 8, 22, 26, 5}, [&](double way_mm) {
    CAPTURE(way_mm);
    CHECK((note(driver, through) != nullptr) == (way_mm > 20));
  });
  driver.button(MouseButton::left, false);
  driver.settle();
  CHECK(driver.lines_with("\"tool\":\"pull\"") == 1);
  CHECK(note(driver, through) == nullptr);
}

TEST_CASE("a wall that was left beyond the opposite one is said after the pull until it is taken back") {
  Driver driver(disc_document(), {1600, 1000, 1});
  driver.settle();
  const std::string said = "The surface passes through itself (";
  CHECK_FALSE(driver.shows(said));
  pull_wall(driver, {22}, [](double) {});
  driver.button(MouseButton::left, false);
  driver.settle();
  CHECK(driver.shows(said));
  driver.app().send(ApplyEdit{Undo{}});
  driver.settle();
  CHECK_FALSE(driver.shows(said));
  driver.app().send(ApplyEdit{Redo{}});  // a person knows it by now
  driver.settle();
  CHECK_FALSE(driver.shows(said));
}

TEST_CASE("a frame whose surface passes through itself is no edit's doing") {
  Document document = disc_document();
  Points crossed = *document.view()->shape.points;
  for (Eigen::Index v = 0; v < crossed.rows(); ++v)
    if (crossed(v, 1) < 0 && std::hypot(crossed(v, 0), crossed(v, 2)) < 8) crossed(v, 1) += 22;
  document.change({}, [&](Structure& disc) {
    Shape shape = *disc.shape(0);
    shape.points = std::make_shared<const Points>(crossed);
    disc.set_shape(1, std::move(shape));
  });
  Driver driver(document, {1600, 1000, 1});
  driver.settle();
  driver.app().send(ShowFrame{1});
  driver.settle();
  CHECK(driver.document().frame == 1);
  CHECK(driver.state().found.intersecting_at_rest > 0);
  CHECK(driver.state().found.intersecting_at_rest != Found::not_known);
  CHECK_FALSE(driver.shows("The surface passes through itself ("));
}

TEST_CASE("what is said of a pull stays within its view where the pointer is at its edge") {
  for (const auto& [width, height] : {std::pair(1280, 800), std::pair(800, 600)}) {
    Driver driver(disc_document(), {width, height, 1});
    pull_wall(driver, {22}, [](double) {});
    const RectPx view = driver.app().layout().image(ViewKind::axial);
    for (const double x : {view.x + 2, view.x + view.width / 2, view.x + view.width - 2})
      for (const double y : {view.y + 2, view.y + view.height - 2}) {
        driver.move(x, y);
        const DrawnItem* moved = note(driver, "\xcf\x83 4.0 mm");
        REQUIRE(moved != nullptr);
        CHECK(moved->seen == moved->rect);
        const DrawnItem* wall = note(driver, through);
        REQUIRE(wall != nullptr);
        CHECK(wall->seen == wall->rect);
      }
    driver.button(MouseButton::left, false);
    driver.settle();
  }
}

}  // namespace homolog
