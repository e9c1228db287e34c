#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <string_view>

#include "app/editor/window/key_pointer.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "tests/driver.h"
#include "tests/must.h"

// The program without a mouse: every control is reached and operated by keys, and so are the views.

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// A bright ball of 22 mm in an image of 60 mm, and a ball of 20 mm with two landmarks as the template.
struct BrightBall {
  TemporaryFolder folder;

  Document document() const {
    Volume image;
    image.geometry.dims = {60, 60, 60};
    image.geometry.origin_mm.setConstant(-29.5);
    std::vector<std::int16_t> values(image.geometry.voxels());
    for (std::size_t i = 0; i < values.size(); ++i) {
      const Vec3 p(static_cast<double>(i % 60) - 29.5, static_cast<double>(i / 60 % 60) - 29.5,
                   static_cast<double>(i / 3600) - 29.5);
      values[i] = static_cast<std::int16_t>(std::clamp(100 * (22.5 - p.norm()), 0.0, 100.0));
    }
    image.data = std::move(values);
    const Mesh mesh = icosphere(3, 20);
    MeshFile ball{mesh.points, mesh.topology->triangles()};
    ball.landmarks = {{"left", Vec3(20, 0, 0)}, {"top", Vec3(0, 0, 20)}};
    const fs::path file = folder.path / "ball.ply";
    REQUIRE(write_mesh_file(ball, file));
    return new_document("", std::make_shared<const Volume>(std::move(image)), test::must(load_template(file.string())));
  }
};

constexpr InputRouter::Held ctrl{false, true, false}, shift{true, false, false}, ctrl_shift{true, true, false};

Vec3 pointed_at(Driver& driver) {
  REQUIRE(driver.state().pointer.hover);
  REQUIRE(driver.state().pointer.hover->p_mm);
  return *driver.state().pointer.hover->p_mm;
}

std::string keys_at(const Driver& driver) {
  return driver.at_keys() == nullptr ? "" : driver.at_keys()->path;
}

}  // namespace

TEST_CASE("a whole job is done with keys alone") {
  const BrightBall ball;
  Driver driver(ball.document());
  REQUIRE(driver.control("side panel/Place").value == "off");
  driver.go_to("side panel/Place");
  driver.press(key::enter);
  driver.settle();
  CHECK(driver.control("side panel/Place").value == "on");
  CHECK(keys_at(driver) == "side panel/Place");

  // A landmark is chosen in the list, and placed with the pointer that keys move.
  driver.go_to("left/row");
  driver.press(' ');
  driver.settle();
  CHECK(driver.state().hand.landmark == "left");
  driver.press(key::escape);
  CHECK(keys_at(driver).empty());
  driver.press('V');
  for (int k = 0; k < 300 && pointed_at(driver).x() < 21.5; ++k) driver.press(key::right, ctrl);
  const Vec3 place = pointed_at(driver);
  CHECK(place.x() == doctest::Approx(22).epsilon(0.05));
  driver.press(key::enter);
  driver.wait_until("the landmark is placed",
                    [&] { return driver.document().view()->shape.landmarks.contains("left"); });
  CHECK(driver.document().view()->shape.landmarks.at("left").isApprox(place, 1e-3));
  driver.press(key::escape);

  // A number is typed, and changed step by step.
  driver.go_to("Width \xcf\x83/value");
  driver.press(key::enter);
  driver.type("9");
  driver.press(key::enter);
  driver.settle();
  CHECK(driver.state().hand.sigma_mm() == 9);
  driver.press(key::right, ctrl);
  driver.settle();
  CHECK(driver.state().hand.sigma_mm() > 9);
  driver.press(key::left, ctrl);
  driver.settle();
  CHECK(driver.state().hand.sigma_mm() == doctest::Approx(9));
  driver.press(key::tab);
  CHECK(keys_at(driver) != "side panel/Deform/Width \xcf\x83/value");
  driver.press(key::escape);

  // What is pulled is pulled by keys too, and given up by Escape.
  driver.press('P');
  driver.press('V');
  for (int k = 0; k < 200 && !driver.state().pointer.hover->on_mesh; ++k) driver.press(key::up, ctrl);
  driver.press(' ');
  for (int k = 0; k < 4; ++k) driver.press(key::up);
  CHECK(driver.state().pointer.drag);
  driver.press(key::escape);
  CHECK_FALSE(driver.state().pointer.drag);
  driver.settle();
  CHECK(driver.document().view()->shape.strokes == 0);
  driver.press(key::down, ctrl);  // the mesh is elsewhere again
  for (int k = 0; k < 200 && !driver.state().pointer.hover->on_mesh; ++k) driver.press(key::down, ctrl);
  driver.press(' ');
  driver.press(key::up);
  driver.press(' ');
  driver.wait_until("the stroke is in the case", [&] { return driver.document().view()->shape.strokes == 1; });
  driver.press(key::escape);

  const Points pulled = *driver.document().view()->shape.points;
  driver.press('N');  // where the pointer was
  driver.wait_until("the mesh has snapped", [&] {
    return (*driver.document().view()->shape.points - pulled).rowwise().norm().maxCoeff() > 0.5;
  });

  // A menu: what was done is listed, and the last of it is taken back.
  driver.go_to("top bar/history");
  driver.press(key::enter);
  CHECK(keys_at(driver) == "top bar/history/Undo: snap");
  driver.press(key::down);
  driver.press(key::up);
  driver.press(key::enter);
  driver.settle();
  CHECK(bool(*driver.document().view()->shape.points == pulled));
  CHECK(keys_at(driver) == "top bar/history");

  // The file is chosen with keys: into a new folder, and under a name.
  driver.press('S', ctrl_shift);
  REQUIRE(driver.state().dialog);
  for (int k = 0; k < 20 && keys_at(driver) != "Save the case/New folder"; ++k) driver.press(key::tab);
  REQUIRE(keys_at(driver) == "Save the case/New folder");
  driver.press(key::enter);
  driver.type("mine");
  driver.press(key::enter);
  driver.settle();
  for (int k = 0; k < 20 && keys_at(driver) != "Save the case/name"; ++k) driver.press(key::tab);
  driver.press(key::enter);
  REQUIRE(ImGui::GetIO().WantTextInput);
  driver.press('A', ctrl);
  driver.type("ball.homolog");
  driver.press(key::enter);
  driver.wait_until("the case is saved", [&] { return driver.case_file().filename() == "ball.homolog"; });
  CHECK(driver.case_file().parent_path().filename() == "mine");
  CHECK(driver.lines_with("\"landmark\"") > 0);
}

TEST_CASE("the program's keys stay its own until a key leads to the controls") {
  const BrightBall ball;
  Driver driver(ball.document());
  driver.press('G');
  CHECK(driver.state().hand.tool == MouseTool::grab);
  const double before_mm = driver.state().look.crosshair_mm.z();
  driver.press(key::up);
  CHECK(driver.state().look.crosshair_mm.z() != before_mm);
  driver.press(key::tab);
  driver.settle();
  CHECK(driver.state().models.shown);
  driver.press(key::tab);
  driver.settle();
  CHECK_FALSE(driver.state().models.shown);

  driver.press(key::f6);
  const std::string first = keys_at(driver);
  CHECK_FALSE(first.empty());
  driver.press(key::tab);
  CHECK_FALSE(driver.state().models.shown);
  CHECK(keys_at(driver) != first);
  driver.press(key::tab, shift);
  CHECK(keys_at(driver) == first);
  driver.press('P');  // letters are still tools
  CHECK(driver.state().hand.tool == MouseTool::pull);
  driver.press(key::f6, shift);
  CHECK(keys_at(driver).empty());
  driver.press(key::f6);
  driver.move(700, 400);  // the mouse takes over
  driver.button(MouseButton::left, true);
  driver.button(MouseButton::left, false);
  CHECK(keys_at(driver).empty());
  driver.press(key::tab);
  driver.settle();
  CHECK(driver.state().models.shown);
}

namespace {

/// The controls of the window that no key led to, though some key should; empty where there is none.
std::string unreached(Driver& driver) {
  std::set<std::string> reached, parts;
  for (int part = 0; part < 20; ++part) {
    driver.press(key::f6);
    if (driver.at_keys() == nullptr) break;
    for (int k = 0; k < 200; ++k) {
      REQUIRE(driver.at_keys() != nullptr);
      const DrawnItem at = *driver.at_keys();
      CHECK_MESSAGE(at.seen.height > 0, at.path, " is marked out of sight");
      if (!reached.insert(at.path).second) break;
      driver.press(key::tab);
    }
  }
  std::string missing;
  for (const DrawnItem& item : driver.items()) {
    const bool has_keys =
        item.is_control() && item.kind != DrawnItem::Kind::track && item.kind != DrawnItem::Kind::area;
    if (has_keys && !item.path.starts_with("status line") && !reached.contains(item.path))
      missing += "\n  " + item.path;
  }
  CHECK(reached.size() > 30);
  return missing;
}

}  // namespace

TEST_CASE("keys lead to every control and each is brought into sight") {
  const BrightBall ball;
  Driver driver(ball.document(), {800, 600, 1});
  for (const char* section : {"Template", "Place", "Export"}) driver.app().send(OpenSection{section, true});
  driver.settle();
  CHECK(unreached(driver) == "");
  driver.app().send(OpenPhantomStudy{});
  driver.wait_until("the model is made", [&] { return driver.state().models.made.model != nullptr; });
  driver.settle();
  CHECK(unreached(driver) == "");
}

TEST_CASE("the arrows go through a list that is longer than its room") {
  const BrightBall ball;
  Driver driver(ball.document(), {800, 600, 1});
  driver.app().send(OpenPhantomStudy{});
  driver.wait_until("the model is made", [&] { return driver.state().models.made.model != nullptr; });
  driver.settle();
  const std::string last = driver.state().models.study.cases.back().name;
  const std::string first = driver.state().models.study.cases.front().name;
  driver.go_to("cases/" + first + "/row");
  for (int k = 0; k < 30 && keys_at(driver) != "cases/" + last + "/row"; ++k) driver.press(key::down);
  REQUIRE(keys_at(driver) == "cases/" + last + "/row");
  driver.press(key::enter);
  driver.settle();
  CHECK(driver.state().models.list.selected == last);
  driver.go_to("Study");
  driver.press(key::enter);
  CHECK(keys_at(driver) == "cases/study menu/New study\xe2\x80\xa6");
  driver.press(key::escape);
  CHECK(keys_at(driver) == "cases/Study");
}

TEST_CASE("a question is answered with keys") {
  const BrightBall ball;
  Driver driver(ball.document());
  driver.app().start_session(EditSession(ball.document()));
  driver.settle();
  driver.app().send(ApplyEdit{SetStiffnessBase{7}});
  driver.settle();
  driver.press('Q', ctrl);
  driver.settle();
  REQUIRE(driver.state().dialog);
  CHECK(keys_at(driver) == "This case was not saved/Save as…");
  driver.press(key::right);
  driver.press(key::left);
  driver.press(key::enter);
  driver.settle();
  REQUIRE(driver.state().dialog);
  CHECK(std::holds_alternative<FileDialog>(*driver.state().dialog));
  driver.press(key::escape);
  CHECK_FALSE(driver.state().dialog);
}

TEST_CASE("the keys' pointer stays in the window when its view is hidden") {
  const BrightBall ball;
  Driver driver(ball.document());
  KeyPointer pointer;
  REQUIRE(pointer.press({.key = 'V'}, driver.app()));  // in the first view
  driver.state().look.maximised = ViewKind::space;
  driver.frames(3);
  REQUIRE(driver.app().layout().images[0].width == 0);
  for (const int arrow : {key::left, key::right, key::up, key::down}) {
    const auto acts = pointer.press({.key = arrow}, driver.app());
    REQUIRE(acts);
    const auto& to = std::get<KeyPointer::Move>(acts->front());
    CHECK(to.x_px >= 0);
    CHECK(to.y_px >= 0);
  }
}

TEST_CASE("the list of keys is of the mode that is shown, and keys scroll it in a small window") {
  Driver driver(new_document("", nullptr, nullptr), {800, 600, 1});
  const auto seen = [&](std::string_view text) {
    return std::ranges::any_of(driver.items(), [&](const DrawnItem& item) {
      return item.kind == DrawnItem::Kind::text && item.name == text && item.seen.height >= item.rect.height - 1;
    });
  };
  const std::string_view first = "the tool", last = "there: moves, presses";
  driver.press(key::f1);
  driver.settle();
  CHECK(seen(first));
  CHECK_FALSE(seen(last));
  driver.press(key::end);
  driver.settle();
  CHECK(seen(last));
  CHECK_FALSE(seen(first));
  driver.press(key::home);
  driver.settle();
  CHECK(seen(first));
  driver.press(key::page_down);
  driver.settle();
  CHECK_FALSE(seen(first));
  driver.press(key::page_up);
  driver.settle();
  CHECK(seen(first));
  for (int k = 0; k < 3; ++k) driver.press(key::down);
  driver.settle();
  CHECK_FALSE(seen(first));
  for (int k = 0; k < 3; ++k) driver.press(key::up);
  driver.settle();
  CHECK(seen(first));
  driver.press(key::escape);
  driver.settle();

  driver.press(key::tab);
  driver.settle();
  REQUIRE(driver.state().models.shown);
  driver.press(key::f1);
  driver.settle();
  CHECK(seen("turns all shapes"));
  CHECK_FALSE(driver.shows("window and level"));
  CHECK_FALSE(driver.shows("draws a contour"));
}

}  // namespace homolog
