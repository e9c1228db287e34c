#include <doctest/doctest.h>

#include "tests/desk.h"
#include "tests/driver.h"

// A case of several structures in the window: what is done by hand goes to the one that is worked on.

namespace homolog {

namespace {

/// A second kidney, half as large and beside the first.
SetStructure small_kidney(const Document& document) {
  const ShapeView first = *document.view();
  const Similarity placed = first.shape.placement;
  const Vec3 middle = bounds_of(*first.shape.points).center();
  Similarity half = placed;
  half.scale = placed.scale / 2;
  half.translation = placed.translation / 2 + middle / 2 + Vec3(30, 0, 0);
  return {.id = "s2",
          .name = "small kidney",
          .source = first.the_template().source,
          .placement = half,
          .the_template = first.structure.the_template};
}

Points points_of(const Driver& driver, const char* id) {
  return *driver.document().view(id)->shape.points;
}

void start_with_two(Driver& driver) {
  driver.app().send(ApplyEdit{small_kidney(driver.document())});
  driver.wait_until("there are two structures", [&] { return driver.document().structures.size() == 2; });
  driver.settle();
}

/// The px of an axial slice where a vertex lies that is nearest to the slice.
std::array<double, 2> on_axial_outline(Driver& driver, const char* id) {
  const Points points = points_of(driver, id);
  driver.state().look.crosshair_mm = points.row(0).transpose();
  driver.settle();
  const auto px = view_map(driver.state(), driver.app().layout(), driver.document(), ViewKind::axial)
                      .to_px(points.row(0).transpose());
  REQUIRE(px);
  return {px->x(), px->y()};
}

}  // namespace

TEST_CASE("what a hand pulls is the structure that is worked on") {
  Driver driver(demo());
  start_with_two(driver);
  const Points first = points_of(driver, "s1"), second = points_of(driver, "s2");

  driver.app().send(ChooseStructure{"s2"});
  driver.settle();
  CHECK(driver.state().look.structure == "s2");
  const auto [x, y] = on_axial_outline(driver, "s2");
  driver.move(x, y);
  driver.frame();
  REQUIRE(driver.state().pointer.hover->on_mesh);
  driver.button(MouseButton::left, true);
  driver.move(x + 12, y + 4);
  driver.frame();
  driver.button(MouseButton::left, false);
  driver.settle();
  CHECK(points_of(driver, "s1") == first);
  CHECK((points_of(driver, "s2") - second).rowwise().norm().maxCoeff() > 1);
  CHECK(driver.lines_with(R"("of":"s2")") == 1);

  driver.app().send(ChooseStructure{});
  driver.settle();
  CHECK(driver.state().look.structure.empty());
  driver.app().send(ApplyEdit{SetStiffnessBase{7}});
  driver.settle();
  CHECK(driver.document().structure("s1")->paint.base == 7);
  CHECK(driver.document().structure("s2")->paint.base == 3);
  CHECK(driver.lines_with(R"("of":"s2")") == 1);
}

TEST_CASE("a structure that undo takes away is worked on no more") {
  Driver driver(demo());
  start_with_two(driver);
  driver.app().send(ChooseStructure{"s2"});
  driver.settle();
  driver.app().send(ApplyEdit{Undo{}});
  driver.settle();
  CHECK(driver.document().structures.size() == 1);
  CHECK(driver.state().look.structure.empty());
  driver.app().send(ChooseStructure{"s2"});
  driver.settle();
  CHECK(driver.shows("There is no structure \"s2\" in this case."));
}

}  // namespace homolog
