#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/model/shapes/study.h"
#include "tests/command_line.h"
#include "tests/driver.h"
#include "tests/must.h"

// The section Optimise of the Models mode, through its widgets.

namespace homolog {

namespace {

/// Five phantom organs with bumps, a hollow and a named landmark, whose vertices were slid off their places.
struct OrganStudy {
  TemporaryFolder folder;
  fs::path study = folder.path / "organs.study.json";
  std::vector<std::string> names;

  explicit OrganStudy(int subdivisions) {
    const Mesh ball = icosphere(subdivisions, 1);
    Study organs;
    for (int k = 0; k < 5; ++k) {
      MeshFile organ{ball.points, ball.topology->triangles()};
      const double turn = 0.09 * std::sin(2.5 * k);
      for (Eigen::Index i = 0; i < organ.points.rows(); ++i) {
        const Vec3 u = (Vec3(ball.points.row(i)) + turn * Vec3(0, 0.3, 1).cross(Vec3(ball.points.row(i)))).normalized();
        const double bumps = 9 * std::exp(-12 * (u - Vec3(0.6, 0.8, 0)).squaredNorm()) -
                             8 * std::exp(-9 * (u - Vec3(0, -0.6, -0.8)).squaredNorm());
        Vec3 p = (40 + bumps) * u;
        p.x() *= 1.3 + 0.1 * std::sin(k);
        p.z() += 0.003 * std::cos(2.0 * k) * p.x() * p.x();
        organ.points.row(i) = p.transpose();
      }
      organ.landmarks = {{"tip", Vec3(organ.points.row(7))}};
      StudyCase one;
      one.name = "organ-" + std::to_string(k);
      one.file = folder.path / (one.name + ".ply");
      REQUIRE(write_mesh_file(organ, one.file));
      names.push_back(one.name);
      organs.cases.push_back(std::move(one));
    }
    REQUIRE(write_study(organs, study));
  }
  std::string all_files() const {
    std::string files;
    for (const std::string& name : names) files += name + ".ply ";
    return files;
  }
};

void open_organs(Driver& driver, const OrganStudy& organs) {
  driver.app().send(OpenStudy{{organs.study}});
  driver.wait_until("the model is made", [&] { return driver.state().models.made.model != nullptr; });
  driver.settle();
  driver.click("models panel/Optimise");
}

void export_shapes_to(Driver& driver, const fs::path& to) {
  driver.click("Study");
  driver.click("study menu/Export shapes as imported…");
  driver.type_into("name", to.string());
  driver.press(key::enter);
  driver.settle();
}

std::string bytes_of(const fs::path& file) {
  return test::must(read_whole_file(file));
}

bool says(Driver& driver, const std::string& words) {
  const auto& notices = driver.app().state().notices;
  return std::any_of(notices.begin(), notices.end(),
                     [&](const Notice& notice) { return notice.text.find(words) != std::string::npos; });
}

bool logs(Driver& driver, const std::string& words) {
  const auto& lines = driver.app().log().lines();
  return std::any_of(lines.begin(), lines.end(),
                     [&](const std::string& line) { return line.find(words) != std::string::npos; });
}

}  // namespace

TEST_CASE("the optimised shapes are those of the command line and are shown and dropped by a click") {
  const OrganStudy organs(3);
  Driver driver(new_document("", nullptr, nullptr), {1280, 1600, 1});
  open_organs(driver, organs);
  ModelsState& models = driver.state().models;
  const auto fitted = models.made.model;
  const std::string study_file = bytes_of(organs.study);
  driver.click("Optimise/Optimise");
  driver.wait_until("the shapes are optimised", [&] { return models.made.optimisation.done != nullptr; });
  driver.settle();
  CHECK(logs(driver, "start optimisation"));
  const auto& bits = models.made.optimisation.bits;
  REQUIRE(bits.size() == 21);
  CHECK(bits.back() < 0.95 * bits.front());
  CHECK(models.made.optimisation.shown);
  driver.point_at("Optimise/Discard");
  CHECK(driver.shows("Largest slide"));
  CHECK(driver.shows("Mean shape, optimised"));

  const Ran ran =
      run(organs.folder, "model " + organs.all_files() + "--optimise --optimised by-line -o line.h5.json --json");
  REQUIRE(ran.status == 0);
  export_shapes_to(driver, organs.folder.path / "by-window");
  CHECK(says(driver, "by-window (optimised)"));
  for (const std::string& name : organs.names) {
    const std::string by_window = bytes_of(organs.folder.path / "by-window" / (name + ".ply"));
    CHECK(by_window == bytes_of(organs.folder.path / "by-line" / (name + ".ply")));
    CHECK(by_window != bytes_of(organs.folder.path / (name + ".ply")));
  }
  const Eigen::VectorXd variances = models.made.model->components->variances();
  CHECK(ran.json()["variances"].get<std::vector<double>>() == std::vector<double>(variances.begin(), variances.end()));
  const OptimisedStudy done = *models.made.optimisation.done;
  CHECK(ran.json()["optimise"]["after"]["bits"].get<double>() == done.after.bits);
  CHECK(ran.json()["optimise"]["largest_slide_mm"].get<double>() == done.largest_slide_mm);

  driver.click("shapes/As fitted");
  CHECK(models.made.model == fitted);
  export_shapes_to(driver, organs.folder.path / "as-fitted");
  CHECK(bytes_of(organs.folder.path / "as-fitted" / "organ-2.ply") == bytes_of(organs.folder.path / "organ-2.ply"));
  driver.click("shapes/Optimised");
  CHECK(models.made.model == done.shapes.model);
  driver.click("Optimise/Discard");
  CHECK(models.made.model == fitted);
  CHECK(models.shapes.shown == models.shapes.fitted.shapes);
  CHECK_FALSE(models.made.optimisation.of);
  driver.settle();
  CHECK(bytes_of(organs.study) == study_file);
}

TEST_CASE("an optimisation is given up by Cancel and dropped when the study changes") {
  const OrganStudy organs(4);
  Driver driver(new_document("", nullptr, nullptr));
  open_organs(driver, organs);
  ModelsState& models = driver.state().models;
  const auto fitted = models.made.model;
  const auto wait_for_rounds = [&] {
    driver.click("Optimise/Optimise");
    driver.wait_until("a round is done", [&] { return models.made.optimisation.bits.size() > 1; });
    REQUIRE(models.made.optimisation.runs());
  };
  driver.settle();
  driver.hurry(true);
  wait_for_rounds();
  driver.click("Optimise/Cancel");
  CHECK_FALSE(models.made.optimisation.of);
  driver.settle();
  CHECK(models.made.model == fitted);
  CHECK_FALSE(logs(driver, "start optimisation"));

  wait_for_rounds();
  driver.app().send(FlipCases{{"organ-3"}});
  driver.wait_until("it is stopped", [&] { return !models.made.optimisation.of; });
  CHECK(says(driver, "The optimisation was stopped, because organ-3 has changed. Optimise again."));
  driver.settle();
  CHECK_FALSE(models.made.optimisation.done);
}

TEST_CASE("optimised shapes stay when a group is typed and go when a case is removed") {
  const OrganStudy organs(2);
  Driver driver(new_document("", nullptr, nullptr));
  open_organs(driver, organs);
  ModelsState& models = driver.state().models;
  driver.click("Optimise/Optimise");
  driver.wait_until("the shapes are optimised", [&] { return models.made.optimisation.done != nullptr; });
  const auto components = models.made.model->components;
  driver.app().send(SetCaseText{"organ-1", "group", "healthy"});
  driver.settle();
  CHECK(models.made.model->components == components);
  CHECK(models.made.model->groups[1] == "healthy");
  driver.app().send(RemoveCase{"organ-4"});
  driver.wait_until("they are dropped", [&] { return !models.made.optimisation.of; });
  CHECK(says(driver, "The optimised shapes were dropped, because organ-4 is not in the model any more."));
  driver.settle();
  CHECK(models.made.model->names.size() == 4);
}

TEST_CASE("Optimise says why it cannot be pressed") {
  const OrganStudy organs(2);
  Driver driver(new_document("", nullptr, nullptr), {1280, 1600, 1});
  driver.app().send(ShowModels{true});
  driver.settle();
  driver.click("models panel/Optimise");
  CHECK_FALSE(driver.control("Optimise/Optimise").enabled);
  CHECK(driver.control("Optimise/Optimise").tip == "At least two shapes in correspondence are needed.");
  ModelsState& models = driver.state().models;
  driver.app().send(OpenStudy{{organs.study}});
  driver.wait_until("the model is made", [&] { return models.made.model != nullptr; });
  driver.settle();
  CHECK(driver.control("Optimise/Optimise").enabled);
  models.runs.evaluating = true;
  CHECK(why_not_optimise(models) == "Wait until the measures are done.");
  models.runs.evaluating = false;
  auto points = std::make_shared<StudyModel>(*models.made.model);
  points->topology = nullptr;
  models.shapes.fitted.model = points;
  driver.frames(2);
  CHECK(driver.control("Optimise/Optimise").tip.starts_with("Vertices slide along faces, and these shapes have none."));
}

TEST_CASE("nothing moves while shapes are optimised and when they are") {
  const OrganStudy organs(1);
  int width_px = 1280;
  SUBCASE("in a wide window") {}
  SUBCASE("in a narrow window") {
    width_px = 800;
  }
  Driver driver(new_document("", nullptr, nullptr), {width_px, 1600, 1});
  open_organs(driver, organs);
  ModelsState& models = driver.state().models;
  models.made.optimisation.of =
      std::make_shared<const StudyToOptimise>(StudyToOptimise{models.shapes.fitted, models.made.alignment});
  driver.frames(2);
  const auto top_px = [&](const char* name) { return driver.control(name).rect.y; };
  const float below_px = top_px("models panel/Sizes"), cancel_px = top_px("Optimise/Cancel"),
              discard_px = top_px("Optimise/Discard");
  CHECK_FALSE(driver.control("Optimise/Discard").enabled);
  models.made.optimisation.bits = {12, 11};
  driver.frames(2);
  CHECK(top_px("Optimise/Cancel") == cancel_px);
  auto done = std::make_shared<OptimisedStudy>();
  done->before = {12, 1, 3, 0.8, 2, 1};
  done->after = {11, 1, 3, 0.9, 1.5, 1};
  models.made.optimisation.done = std::move(done);
  driver.frames(2);
  CHECK(top_px("Optimise/Discard") == discard_px);
  CHECK(driver.control("Optimise/Discard").enabled);
  CHECK(top_px("models panel/Sizes") == below_px);
}

}  // namespace homolog
