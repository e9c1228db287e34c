#include <doctest/doctest.h>

#include "app/editor/state/models/gallery.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/model/shapes/study.h"
#include "tests/driver.h"
#include "tests/must.h"

// The pages of the gallery, through its widgets.

namespace homolog {

TEST_CASE("the gallery turns its pages by buttons keys and the wheel") {
  Driver driver(new_document({}, nullptr, nullptr));
  Study study;
  constexpr std::size_t count = 2 * shapes_a_page + 3;
  for (std::size_t k = 0; k < count; ++k) {
    Mesh ball = icosphere(1, 10);
    ball.points.col(0) *= 1 + 0.01 * static_cast<double>(k);
    StudyCase one;
    one.name = "ball-" + std::to_string(100 + k);
    one.file = driver.folder() / (one.name + ".ply");
    REQUIRE(write_mesh(ball, one.file));
    study.cases.push_back(std::move(one));
  }
  const auto path = driver.folder() / "balls.study.json";
  REQUIRE(write_study(study, path));
  driver.app().send(ShowModels{true});
  driver.app().send(OpenStudy{{path}});
  driver.wait_until("the model is made", [&] { return driver.state().models.made.model != nullptr; });
  driver.settle();
  const ModelsState& models = driver.state().models;

  CHECK(driver.shows("page 1 of 3"));
  driver.click("page on");
  CHECK(driver.shows("page 2 of 3"));
  driver.press(key::page_down);
  CHECK(models.gallery.page == 2);
  driver.press(key::page_down);
  CHECK(models.gallery.page == 2);
  driver.press(key::page_up);
  driver.settle();
  CHECK(driver.shows("page 2 of 3"));

  driver.point_at("gallery/cells");
  driver.wheel(-1);
  driver.settle();
  CHECK(models.gallery.page == 2);
  driver.wheel(1);
  driver.settle();
  CHECK(models.gallery.page == 1);
  const double distance_mm = models.gallery.camera.distance_mm;
  driver.hold_keys({false, true, false});
  driver.wheel(1);
  driver.settle();
  driver.hold_keys({});
  CHECK(models.gallery.page == 1);
  CHECK(models.gallery.camera.distance_mm < distance_mm);

  // What is chosen in the list is on the screen.
  driver.click("ball-100/row");
  driver.settle();
  CHECK(models.gallery.page == 0);
  // A click in a cell chooses the shape of this page that lies there.
  driver.click("page on");
  driver.settle();
  const RectPx cell = page_grid(models, driver.control("gallery/cells").rect).cell(shapes_a_page + 1);
  driver.move(cell.x + 2, cell.y + cell.height - 2);
  driver.button(MouseButton::left, true);
  driver.button(MouseButton::left, false);
  driver.settle();
  CHECK(models.list.selected == study.cases[shapes_a_page + 1].name);
  CHECK(models.gallery.page == 1);
}

}  // namespace homolog
