#include <doctest/doctest.h>

#include "core/base/files/files.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "tests/driver.h"
#include "tests/must.h"

// What a recipe measures of the shown mesh: listed, live, drawn on it, and written.

namespace homolog {

namespace {

namespace fs = std::filesystem;

constexpr double radius_mm = 40;

/// A ball with a landmark at a vertex at either pole, and a recipe of its template's name beside it.
struct MeasuredBall {
  TemporaryFolder folder;
  fs::path file = folder.path / "ball.ply";
  Document document;

  MeasuredBall() {
    const Mesh mesh = icosphere(3, radius_mm);
    const auto upright = Eigen::Quaterniond::FromTwoVectors(Vec3(mesh.points.row(0)), Vec3::UnitZ());
    MeshFile ball{mesh.points * upright.toRotationMatrix().transpose(), mesh.topology->triangles()};
    ball.landmarks = {{"north", Vec3(0, 0, radius_mm)}, {"south", Vec3(0, 0, -radius_mm)}};
    REQUIRE(write_mesh_file(ball, file));
    REQUIRE(write_whole_file(folder.path / "ball.recipe.json", R"({
  "homolog_recipe": 1, "name": "Ball",
  "measurements": [
    {"name": "across", "kind": "distance", "from": {"kind": "landmark", "landmark": "north"},
     "to": {"kind": "landmark", "landmark": "south"}},
    {"name": "to the apex", "kind": "distance", "from": {"kind": "landmark", "landmark": "north"},
     "to": {"kind": "landmark", "landmark": "apex"}},
    {"name": "content", "kind": "volume"}
  ]})"));
    document = new_document("", nullptr, test::must(load_template(file.string())));
  }
};

/// Pulls the north pole outwards in the coronal view, as a hand does; the button stays down.
void pull_north(Driver& driver, double by_mm) {
  const ViewMap map = view_map(driver.state(), driver.app().layout(), driver.document(), ViewKind::coronal);
  const auto from = map.to_px(Vec3(0, 0, radius_mm)), to = map.to_px(Vec3(0, 0, radius_mm + by_mm));
  REQUIRE((from && to));
  driver.move(from->x(), from->y());
  driver.frame();
  REQUIRE(driver.state().pointer.hover->on_mesh);
  driver.button(MouseButton::left, true);
  driver.move(to->x(), to->y());
  driver.frame();
}

}  // namespace

TEST_CASE("the recipe beside a template measures the mesh while a hand pulls it and after undo") {
  const MeasuredBall ball;
  Driver driver(ball.document, {1280, 2400, 1});
  driver.settle();
  CHECK(driver.state().measurements.source == (ball.folder.path / "ball.recipe.json").string());
  driver.click("side panel/Measurements");
  driver.wait_until("it is measured", [&] { return driver.shows("80.0 mm"); });
  CHECK(driver.shows("across"));
  CHECK(driver.shows(" ml"));

  pull_north(driver, 5);
  driver.wait_until("the preview is measured", [&] { return driver.shows("85.0 mm"); });
  CHECK(driver.app().snapshot().steps_made == 0);
  CHECK_FALSE(driver.shows("80.0 mm"));
  driver.button(MouseButton::left, false);
  driver.settle();
  CHECK(driver.shows("85.0 mm"));
  driver.click("undo");
  driver.wait_until("undo is measured", [&] { return driver.shows("80.0 mm"); });
  driver.click("redo");
  driver.wait_until("redo is measured", [&] { return driver.shows("85.0 mm"); });
}

TEST_CASE("a measurement is drawn by its eye and one that cannot be taken names the landmark that is missing") {
  const MeasuredBall ball;
  Driver driver(ball.document, {1280, 2400, 1});
  driver.click("side panel/Measurements");
  driver.settle();
  CHECK_FALSE(driver.control("to the apex/eye").enabled);
  CHECK(driver.control("to the apex/eye").tip.starts_with("The mesh has no landmark \"apex\""));
  CHECK_FALSE(driver.control("content/eye").enabled);
  CHECK_FALSE(driver.shows("across  80.0 mm"));
  driver.click("across/eye");
  driver.settle();
  CHECK(driver.state().measurements.drawn == std::set<std::string>{"across"});
  CHECK(driver.shows("across  80.0 mm"));
  // It stays on the mesh, and live, while its section is folded.
  driver.click("side panel/Measurements");
  pull_north(driver, 5);
  driver.button(MouseButton::left, false);
  driver.settle();
  CHECK(driver.shows("across  85.0 mm"));
  driver.click("side panel/Measurements");
  driver.click("across/eye");
  driver.settle();
  CHECK_FALSE(driver.shows("across  85.0 mm"));
}

TEST_CASE("a recipe is chosen by its name or as a file and its measurements are written as a table") {
  const MeasuredBall ball;
  Driver driver(ball.document, {1280, 2400, 1});
  driver.click("side panel/Measurements");
  driver.settle();
  driver.click("Measurements/recipe");
  driver.click("recipe/ventricle");
  driver.settle();
  CHECK(driver.state().measurements.source == "ventricle");
  CHECK_FALSE(driver.shows("across"));
  driver.click("Measurements/Recipe\xe2\x80\xa6");
  driver.type_into("name", (ball.folder.path / "ball.recipe.json").string());
  driver.press(key::enter);
  driver.settle();
  CHECK(driver.shows("80.0 mm"));

  const fs::path table = driver.folder() / "table.csv";
  driver.click("Measurements/Table\xe2\x80\xa6");
  driver.type_into("name", table.string());
  driver.press(key::enter);
  driver.wait_until("the table is written", [&] { return fs::exists(table); });
  driver.settle();
  const std::string text = test::must(read_whole_file(table));
  CHECK(text.starts_with("name,across mm,to the apex mm,content ml\n"));
  CHECK(text.find(",80,,2") != std::string::npos);

  REQUIRE(write_whole_file(ball.folder.path / "other.recipe.json", "{}"));
  driver.app().send(ChooseRecipe{(ball.folder.path / "other.recipe.json").string()});
  driver.settle();
  REQUIRE_FALSE(driver.state().notices.empty());
  CHECK(driver.state().notices.back().text.find("other.recipe.json") != std::string::npos);
  CHECK(driver.shows("80.0 mm"));
}

}  // namespace homolog
