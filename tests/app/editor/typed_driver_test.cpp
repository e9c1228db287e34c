#include <doctest/doctest.h>

#include <algorithm>

#include "core/volume/volume_io.h"
#include "tests/beating_ball.h"
#include "tests/driver.h"
#include "tests/must.h"
#include "tests/organ_scan.h"

// Numbers that are typed: taken as they are, or refused with their limits.

namespace homolog {

namespace {

void type_number(Driver& driver, std::string_view name, std::string_view text, int last = key::enter) {
  driver.state().notices.clear();
  driver.type_into(name, text);
  driver.press(last);
  driver.settle();
}

bool notice_says(Driver& driver, std::string_view words) {
  return std::any_of(driver.state().notices.begin(), driver.state().notices.end(),
                     [&](const Notice& one) { return one.text.find(words) != std::string::npos; });
}

}  // namespace

TEST_CASE("a scale beyond its limits is refused with them and the mesh stays") {
  const OrganScan scan;
  Driver driver(scan.document(), {1280, 1400, 1});
  driver.click("side panel/Place");
  const Points before = *driver.document().view()->shape.points;
  const int placements = driver.lines_with("\"placement\"");
  for (const char* text : {"8", "0.1", "-1", "80", "1e400", "1,5", "1.2.3", "abc", "2 x"}) {
    CAPTURE(text);
    type_number(driver, "Place/Scale/value", text);
    CHECK(driver.control("Place/Scale/value").value == "1.000");
    CHECK(*driver.document().view()->shape.points == before);
    CHECK(notice_says(driver, std::string("Scale stays as it is: \"") + text + "\""));
  }
  type_number(driver, "Place/Scale/value", "8");
  CHECK(driver.shows("Type a number from 0.5 to 2."));
  type_number(driver, "Place/Scale/value", "1,5");
  CHECK(driver.shows("has a comma"));
  CHECK(driver.lines_with("\"placement\"") == placements);
  for (const int last : {key::enter, key::tab}) {
    type_number(driver, "Place/Scale/value", last == key::enter ? "1.25" : "1.75", last);
    CHECK(driver.document().view()->shape.placement.scale == doctest::Approx(last == key::enter ? 1.25 : 1.75));
    CHECK(driver.state().notices.empty());
  }
  type_number(driver, "Place/Scale/value", "1.5", key::escape);
  CHECK(driver.document().view()->shape.placement.scale == doctest::Approx(1.75));
}

TEST_CASE("every number of the panel is taken as it was typed or refused with a sentence") {
  Document cine = BeatingBall::document();
  for (const bool is_cine : {true, false}) {
    const OrganScan scan;
    Driver driver(is_cine ? cine : scan.document(), {1280, 3000, 1});
    for (const char* section : {"Template", "Place", "Export"}) {
      driver.app().send(OpenSection{section, true});
      driver.frames(2);
    }
    driver.app().send(SetPicture{PictureOptions{ViewKind::axial}});
    for (const MouseTool tool : {is_cine ? MouseTool::relax : MouseTool::stiffness}) {
      driver.app().send(ChooseTool{tool});
      driver.settle();
      std::vector<std::string> numbers;
      for (const DrawnItem& item : driver.items())
        if (item.kind == DrawnItem::Kind::number && item.enabled) numbers.push_back(item.path);
      CHECK(numbers.size() > 8);
      for (const std::string& name : numbers)
        for (const char* text : {"123456789", "1,5"}) {
          if (!driver.has(name)) continue;
          CAPTURE(name);
          CAPTURE(text);
          const std::string before = driver.control(name).value;
          type_number(driver, name, text);
          const bool refused = notice_says(driver, std::string("stays as it is: \"") + text + "\"");
          CHECK(refused);
          CHECK(driver.control(name).value == before);
        }
    }
  }
}

TEST_CASE("a frame or a count that is no whole number is refused") {
  Driver driver(BeatingBall::document(), {1280, 1400, 1});
  type_number(driver, "Cine/Frame/value", "2.6");
  CHECK(driver.document().frame == 0);
  CHECK(notice_says(driver, "is not a whole number"));
  type_number(driver, "Cine/Frame/value", "6");
  CHECK(driver.document().frame == 0);
  CHECK(notice_says(driver, "from 0 to 5"));
  type_number(driver, "Cine/Frame/value", " +3 ");
  CHECK(driver.document().frame == 3);
}

TEST_CASE("a unit may be typed with a number") {
  const OrganScan scan;
  Driver driver(scan.document(), {1280, 1400, 1});
  driver.press('C');
  type_number(driver, "Brush radius/value", "12.5 mm");
  CHECK(driver.state().hand.brush.radius_mm == 12.5);
  CHECK(driver.state().notices.empty());
}

}  // namespace homolog
