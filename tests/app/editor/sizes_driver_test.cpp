#include <doctest/doctest.h>

#include "core/base/files/files.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/model/shapes/study.h"
#include "tests/driver.h"
#include "tests/must.h"

// What the Models mode measures of the study's cases, and how it compares two observers.

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// A study of two balls with a landmark at either pole.
fs::path ball_study(const fs::path& folder, double first_mm, double second_mm) {
  fs::create_directories(folder);
  Study study;
  for (const auto& [name, radius_mm] : {std::pair("one", first_mm), std::pair("two", second_mm)}) {
    Mesh ball = icosphere(3, radius_mm);
    ball.points.col(0) *= name == std::string("two") ? 1.1 : 1.0;
    MeshFile file{ball.points, ball.topology->triangles()};
    file.landmarks = {{"north", Vec3(0, 0, radius_mm)}, {"south", Vec3(0, 0, -radius_mm)}};
    REQUIRE(write_mesh_file(file, folder / (std::string(name) + ".ply")));
    StudyCase one;
    one.name = name;
    one.file = folder / (std::string(name) + ".ply");
    study.cases.push_back(std::move(one));
  }
  REQUIRE(write_study(study, folder / "balls.study.json"));
  return folder / "balls.study.json";
}

void choose_file(Driver& driver, const fs::path& file) {
  driver.type_into("name", file.string());
  driver.press(key::enter);
}

}  // namespace

TEST_CASE("sizes of a study are listed and written and it is compared with another observer's") {
  Driver driver(new_document("", nullptr, nullptr));
  const fs::path mine = ball_study(driver.folder() / "mine", 20, 24),
                 other = ball_study(driver.folder() / "other", 21, 24);
  driver.app().send(OpenStudy{{mine}});
  driver.wait_until("the cases are measured", [&] { return driver.state().models.shapes.sizes.size() == 2; });
  driver.settle();
  driver.click("models panel/Sizes");
  driver.point_at("Sizes/Table…");
  const auto says = [&](const char* words) {
    return std::any_of(driver.items().begin(), driver.items().end(),
                       [&](const DrawnItem& item) { return item.name.find(words) != std::string::npos; });
  };
  CHECK(says("SD"));
  CHECK(says("40.0"));  // mm from pole to pole
  driver.click("one/sizes");
  CHECK(driver.state().models.list.selected == "one");
  driver.click("Sizes/Table…");
  choose_file(driver, driver.folder() / "sizes.csv");
  driver.wait_until("the table is written", [&] { return fs::exists(driver.folder() / "sizes.csv"); });
  CHECK(test::must(read_whole_file(driver.folder() / "sizes.csv"))
            .starts_with("case,volume_ml,area_mm2,north to south mm,centroid_size_mm\none,33."));
  driver.click("Sizes/Landmarks…");
  choose_file(driver, driver.folder() / "balls.tps");
  driver.wait_until("the landmarks are written", [&] { return fs::exists(driver.folder() / "balls.tps"); });
  CHECK(test::must(read_whole_file(driver.folder() / "balls.tps")).starts_with("LM3=2\n0 0 20\n0 0 -20\nID=one\n"));

  driver.click("models panel/Sizes");
  driver.click("models panel/Observers");
  driver.click("Observers/Compare with a study…");
  choose_file(driver, other);
  driver.wait_until("both are compared", [&] { return driver.state().models.observer.comparison.has_value(); });
  driver.settle();
  CHECK(driver.state().models.observer.comparison->cases.size() == 2);
  driver.point_at("Observers/Table…");
  CHECK(driver.shows("Distance of the landmarks"));
  CHECK(driver.shows("0.50"));  // mean of 1 mm and 0 mm
  CHECK(driver.shows("the other observer's volume minus this one"));
  CHECK(driver.shows("SD"));
  CHECK_FALSE(driver.shows("-0.0"));

  // A comparison of shapes that were edited since is not shown as if it were one of these.
  Mesh edited = icosphere(3, 26);
  MeshFile file{edited.points, edited.topology->triangles()};
  file.landmarks = {{"north", Vec3(0, 0, 26)}, {"south", Vec3(0, 0, -26)}};
  REQUIRE(write_mesh_file(file, driver.folder() / "mine" / "edited.ply"));
  const double dice = driver.state().models.observer.comparison->cases.at(0).agreement.dice;
  driver.state().models.study.cases.at(0).file = driver.folder() / "mine" / "edited.ply";
  ++driver.state().models.kept.shapes_revision;
  driver.wait_until("the comparison is dropped", [&] { return driver.has("Observers/Compare again"); });
  driver.settle();
  driver.click("Observers/Compare again");
  driver.wait_until("both are compared anew", [&] { return driver.state().models.observer.comparison.has_value(); });
  CHECK(driver.state().models.observer.comparison->cases.at(0).agreement.dice < dice - 0.1);
}

TEST_CASE("the slider of the gallery's glyphs has its whole name in a window of 800 px") {
  Driver driver(new_document("", nullptr, nullptr), {800, 600, 1});
  driver.app().send(OpenStudy{{ball_study(driver.folder() / "mine", 20, 24)}});
  driver.state().models.shown = true;
  driver.wait_until("there is a model", [&] { return driver.state().models.made.model != nullptr; });
  driver.settle();
  CHECK(driver.shows("Spacing"));
}

TEST_CASE("the report is written of the study's file as the model is aligned and by the recipe of its template") {
  Driver driver(new_document("", nullptr, nullptr));
  const fs::path study = ball_study(driver.folder() / "mine", 20, 24), page = driver.folder() / "balls.html";
  const fs::path the_template = driver.folder() / "mine/one.ply";
  struct Asked {
    fs::path study;
    Alignment alignment;
    std::string the_template;
  };
  std::vector<Asked> asked;  // by the worker's thread, before it ends
  EditorOptions options;
  options.files = {study};
  options.write_report = [&](const fs::path& of, Alignment alignment, const std::string& by, const fs::path& out,
                             Progress&) -> Result<std::vector<std::string>> {
    asked.push_back({of, alignment, by});
    if (auto written = write_whole_file(out, "page"); !written) return fail(written.error());
    return std::vector<std::string>{"the page is short"};
  };
  driver.app().start(options);
  driver.wait_until("the model is made", [&] { return driver.state().models.made.model != nullptr; });
  driver.settle();
  const auto report = [&] {
    fs::remove(page);
    driver.click("Report…");
    choose_file(driver, page);
    driver.wait_until("the report is written", [&] { return fs::exists(page); });
    driver.settle();
  };
  report();
  REQUIRE(asked.size() == 1);
  CHECK(asked.front().study == study);
  CHECK(asked.front().alignment == driver.state().models.made.alignment);
  CHECK(asked.front().the_template.empty());
  CHECK(driver.shows("the page is short"));

  driver.state().models.study.template_file = the_template;
  report();
  CHECK(asked.at(1).the_template.empty());  // it has no recipe
  REQUIRE(write_whole_file(driver.folder() / "mine/one.recipe.json",
                           R"({"homolog_recipe": 1, "measurements": [{"name": "content", "kind": "volume"}]})"));
  report();
  CHECK(asked.at(2).the_template == the_template);
  driver.state().models.study.template_file = "built-in:vertebra";
  report();
  CHECK(asked.at(3).the_template == "built-in:vertebra");
}

}  // namespace homolog
