#include <doctest/doctest.h>

#include <cmath>

#include "app/editor/scene/mesh_colouring.h"
#include "app/editor/work/models/model_help.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/model/files/statismo.h"
#include "core/model/shapes/study.h"
#include "tests/command_line.h"
#include "tests/driver.h"
#include "tests/must.h"

// How far the shown mesh is from a model: as the verb says, live, and on the mesh.

namespace homolog {

namespace {

constexpr double radius_mm = 40;

/// Seven balls, each drawn out along two axes; the model of the first six. The seventh is the template of a case.
struct ScoredBalls {
  TemporaryFolder folder;
  std::vector<fs::path> files;
  Document document;

  ScoredBalls() {
    constexpr std::array<std::array<double, 2>, 7> drawn{
        {{0.9, 1}, {1, 1.1}, {1.1, 0.95}, {0.95, 0.9}, {1.05, 1.05}, {1, 0.92}, {1.12, 1.08}}};
    std::string names;
    for (std::size_t k = 0; k < drawn.size(); ++k) {
      Mesh ball = icosphere(3, radius_mm);
      ball.points.col(0) *= drawn[k][0];
      ball.points.col(1) *= drawn[k][1];
      ball.points.col(2).array() += (k % 2 == 0 ? 0.05 : -0.05) * ball.points.col(0).array().square() / radius_mm;
      files.push_back(folder.path / ("b" + std::to_string(k) + ".ply"));
      REQUIRE(write_mesh(ball, files.back()));
      if (k < 6) names += " " + files.back().filename().string();
    }
    REQUIRE(run(folder, "model" + names + " --keep-scale --variance 0.99 -o m.h5").status == 0);
    document = new_document("", nullptr, test::must(load_template(files[6].string())));
  }
  void write_balls_study(std::size_t count, const char* name = "balls.study.json", std::size_t first = 0) const {
    Study study;
    for (std::size_t k = first; k < count; ++k) {
      StudyCase one;
      one.name = "b" + std::to_string(k);
      one.file = files[k];
      study.cases.push_back(one);
    }
    REQUIRE(write_study(study, folder.path / name));
  }
  /// What the verb says of the case as it is on the disk.
  Json of_verb(const Driver& driver) const {
    const Ran ran = run(folder, "score '" + driver.case_file().string() + "' --model m.h5 -o scores --json");
    REQUIRE_MESSAGE(ran.status == 0, ran.errors);
    return ran.json()["subjects"][0];
  }
};

/// Opens the section, and the model in it as a hand does.
void score_by_file(Driver& driver, const fs::path& model) {
  driver.click("side panel/Score");
  driver.click("score model/File's");
  driver.click("Score/Choose the model\xe2\x80\xa6");
  driver.type_into("name", model.string());
  driver.press(key::enter);
  driver.wait_until("the model is read", [&] { return driver.state().scoring.of_file != nullptr; });
  driver.settle();
}

std::string text_of(double value, const char* pattern) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), pattern, value);
  return text.data();
}

/// Pulls the top of the ball outwards in the coronal view.
void pull_top(Driver& driver, double by_mm) {
  const Points& points = *driver.document().view()->shape.points;
  Eigen::Index top = 0;
  points.col(2).maxCoeff(&top);
  driver.app().send(LookAt{points.row(top)});
  driver.settle();
  const ViewMap map = view_map(driver.state(), driver.app().layout(), driver.document(), ViewKind::coronal);
  const Vec3 from = points.row(top), to = from + Vec3(0, 0, by_mm);
  const auto from_px = map.to_px(from), to_px = map.to_px(to);
  REQUIRE((from_px && to_px));
  driver.move(from_px->x(), from_px->y());
  driver.frame();
  REQUIRE(driver.state().pointer.hover->on_mesh);
  driver.button(MouseButton::left, true);
  driver.move(to_px->x(), to_px->y());
  driver.frame();
  driver.button(MouseButton::left, false);
  driver.settle();
}

void check_as_the_verb_says(Driver& driver, const ScoredBalls& balls) {
  const Json said = balls.of_verb(driver);
  CHECK(driver.shows(text_of(said["distance"].get<double>(), "%.2f \xcf\x83")));
  CHECK(driver.shows(text_of(said["residual_mm"].get<double>(), "%.2f mm")));
  CHECK(driver.shows(text_of(said["percentile"].get<double>(), "%.0f %%")));
  for (std::size_t mode = 0; mode < std::min<std::size_t>(5, said["modes"].size()); ++mode)
    CHECK(driver.shows(text_of(std::abs(said["modes"][mode].get<double>()), "%.2f \xcf\x83")));
  REQUIRE(driver.state().scoring.z != nullptr);
  for (const auto& entry : fs::directory_iterator(balls.folder.path / "scores")) {
    if (entry.path().extension() != ".vtp") continue;
    const MeshFile written = test::must(read_mesh_file(entry.path()));
    CHECK((written.arrays.at("z") - *driver.state().scoring.z).cwiseAbs().maxCoeff() < 1e-6);
  }
}

}  // namespace

TEST_CASE("the window scores the mesh against a model's file as the verb does and again after an edit and undo") {
  const ScoredBalls balls;
  Driver driver(balls.document, {1280, 2400, 1});
  driver.settle();
  score_by_file(driver, balls.folder.path / "m.h5");
  check_as_the_verb_says(driver, balls);
  const VertexScalars before = *driver.state().scoring.z;

  pull_top(driver, 10);
  REQUIRE(driver.app().snapshot().steps_made == 1);
  check_as_the_verb_says(driver, balls);
  Eigen::Index top = 0;
  driver.document().view()->shape.points->col(2).maxCoeff(&top);
  CHECK((*driver.state().scoring.z)[top] > before[top] + 3);
  driver.click("undo");
  driver.wait_until("undo is scored",
                    [&] { return driver.state().scoring.z != nullptr && *driver.state().scoring.z == before; });
  check_as_the_verb_says(driver, balls);
}

TEST_CASE("the score colours the mesh red where it lies outside of the mean and blue where it lies within") {
  const ScoredBalls balls;
  Driver driver(balls.document, {1280, 2400, 1});
  driver.settle();
  CHECK_FALSE(driver.control("overlay/Score").enabled);
  CHECK(driver.control("overlay/Score").tip.find("in the section Score") != std::string::npos);
  score_by_file(driver, balls.folder.path / "m.h5");
  driver.click("Score/Colour the mesh by z");
  driver.settle();
  CHECK(shown_colouring(driver.state()) == Colouring::score);
  pull_top(driver, 15);
  const VertexScalars& z = *driver.state().scoring.z;
  Eigen::Index most = 0;
  const double highest = z.maxCoeff(&most);
  REQUIRE(highest > 3);
  const VertexScalars within = -z;
  const auto colour = [&](const VertexScalars& of) {
    return mesh_colours(*driver.document().view(), Colouring::score, {}, 1, nullptr,
                        &of)[static_cast<std::size_t>(most)];
  };
  CHECK(colour(z) == diverging_scale().back());
  CHECK(colour(within) == diverging_scale().front());
  CHECK(diverging_scale().back()[0] > diverging_scale().back()[2]);
  // The colours stay, and live, while the section is folded.
  driver.click("side panel/Score");
  driver.click("undo");
  driver.wait_until("undo is scored", [&] {
    return driver.state().scoring.z != nullptr && driver.state().scoring.z->maxCoeff() < highest;
  });
  driver.click("side panel/Score");
  driver.click("Score/Colour the mesh by z");
  driver.settle();
  CHECK(shown_colouring(driver.state()) == Colouring::vertex_hue);
}

TEST_CASE("the score's farthest vertex leads there and a mesh that does not fit the model is refused with a sentence") {
  const ScoredBalls balls;
  Driver driver(balls.document, {1280, 2400, 1});
  driver.settle();
  driver.click("side panel/Score");
  CHECK(driver.shows("Open a study of this template (Tab), or choose a model's file"));
  driver.click("score model/File's");
  driver.settle();
  CHECK(driver.shows("Choose the model first"));
  driver.click("side panel/Score");
  score_by_file(driver, balls.folder.path / "m.h5");
  pull_top(driver, 15);
  driver.app().send(LookAt{Vec3::Zero()});
  driver.settle();
  driver.click("Score/Farthest vertex");
  driver.settle();
  Eigen::Index most = 0;
  driver.state().scoring.z->cwiseAbs().maxCoeff(&most);
  CHECK((driver.state().look.crosshair_mm - Vec3(driver.document().view()->shape.points->row(most))).norm() < 1e-9);

  const Mesh coarse = icosphere(2, radius_mm);
  for (int k = 0; k < 3; ++k) {
    Mesh ball = coarse;
    ball.points.col(0) *= 1 + 0.1 * k;
    REQUIRE(write_mesh(ball, balls.folder.path / ("coarse" + std::to_string(k) + ".ply")));
  }
  REQUIRE(run(balls.folder, "model coarse0.ply coarse1.ply coarse2.ply -o coarse.h5").status == 0);
  driver.app().send(OpenScoreModel{{balls.folder.path / "coarse.h5"}});
  driver.settle();
  CHECK(driver.shows("The mesh has 642 vertices and the model 162. Choose a model of this template."));
  CHECK(driver.state().scoring.z == nullptr);
  CHECK_FALSE(driver.has("Score/Colour the mesh by z"));
}

TEST_CASE("another study that is opened while the section is folded scores the mesh in place of the first") {
  const ScoredBalls balls;
  balls.write_balls_study(6);
  balls.write_balls_study(5, "others.study.json", 1);
  Driver driver(balls.document, {1280, 2400, 1});
  driver.settle();
  const auto open = [&](const char* name) {
    const auto before = driver.state().models.shapes.fitted.model;
    driver.app().send(OpenStudy{{balls.folder.path / name}});
    driver.wait_until("the study has a model", [&] {
      const auto& now = driver.state().models.shapes.fitted.model;
      return now != nullptr && now != before;
    });
    driver.state().models.shown = false;
    driver.settle();
  };
  open("balls.study.json");
  driver.click("side panel/Score");
  driver.wait_until("it is scored", [&] { return driver.state().scoring.z != nullptr; });
  CHECK(driver.state().scoring.of_study->scores.cols() == 6);
  driver.click("side panel/Score");
  open("others.study.json");
  driver.click("side panel/Score");
  driver.frame();
  CHECK((driver.state().scoring.of_study == nullptr || driver.state().scoring.of_study->scores.cols() == 4));
  driver.wait_until("it is scored again", [&] { return driver.state().scoring.z != nullptr; });
  CHECK(driver.state().scoring.of_study->scores.cols() == 4);
}

TEST_CASE("the open study's model scores the mesh without its own case") {
  const ScoredBalls balls;
  balls.write_balls_study(6);
  Driver driver(balls.document, {1280, 2400, 1});
  driver.settle();
  driver.app().send(OpenStudy{{balls.folder.path / "balls.study.json"}});
  driver.wait_until("the study has a model", [&] { return driver.state().models.shapes.fitted.model != nullptr; });
  driver.state().models.shown = false;
  driver.click("side panel/Score");
  driver.wait_until("it is scored", [&] { return driver.state().scoring.z != nullptr; });
  CHECK(driver.state().scoring.left_out.empty());
  CHECK(driver.state().scoring.of_study->scores.cols() == 6);

  // A case of the study is scored by the others.
  Study own = test::must(read_study(balls.folder.path / "balls.study.json")).study;
  own.cases.back().file = driver.case_file();
  REQUIRE(write_study(own, balls.folder.path / "own.study.json"));
  driver.app().send(OpenStudy{{balls.folder.path / "own.study.json"}});
  driver.wait_until("it is left out", [&] { return driver.state().scoring.left_out == "b5"; });
  driver.state().models.shown = false;
  driver.wait_until("five score it", [&] {
    const auto& model = driver.state().scoring.of_study;
    return model != nullptr && model->scores.cols() == 5 && driver.state().scoring.z != nullptr;
  });
  driver.app().send(OpenStudy{{balls.folder.path / "balls.study.json"}});
  driver.wait_until("all score it again", [&] {
    const auto& model = driver.state().scoring.of_study;
    return driver.state().scoring.left_out.empty() && model != nullptr && model->scores.cols() == 6;
  });
  driver.state().models.shown = false;
  driver.settle();

  // The model of five others is that of `model` with their files.
  const StudyModel& study = *driver.state().models.shapes.fitted.model;
  const ShapeModel others = test::must(model_of_others(study, 5));
  REQUIRE(run(balls.folder, "model b0.ply b1.ply b2.ply b3.ply b4.ply --variance 0.95 -o five.h5").status == 0);
  const ShapeModel five = test::must(read_model(balls.folder.path / "five.h5"));
  REQUIRE(others.modes() == five.modes());
  CHECK((others.variances - five.variances).norm() < 1e-3 * five.variances.norm());
  CHECK((others.left_out_distances - five.left_out_distances).norm() < 1e-2 * five.left_out_distances.norm());
  CHECK(others.alignment == five.alignment);
  CHECK(study.model.alignment == five.alignment);
  const Points ball = test::must(read_mesh_file(balls.files[5])).points;
  CHECK(test::must(score_shape(others, ball)).distance ==
        doctest::Approx(test::must(score_shape(five, ball)).distance).epsilon(0.01));
}

TEST_CASE("a case that the open study flips is scored flipped and as it lies again where the study does not") {
  const ScoredBalls balls;
  balls.write_balls_study(6);
  Driver driver(balls.document, {1280, 2400, 1});
  driver.settle();
  Study own = test::must(read_study(balls.folder.path / "balls.study.json")).study;
  own.cases.back().file = driver.case_file();
  const auto open = [&](bool flipped, const char* name) {
    own.cases.back().flipped = flipped;
    REQUIRE(write_study(own, balls.folder.path / name));
    driver.app().send(OpenStudy{{balls.folder.path / name}});
    driver.wait_until("the study is open", [&] { return driver.state().models.kept.file == balls.folder.path / name; });
    driver.state().models.shown = false;
    driver.settle();
  };
  open(true, "flipped.study.json");
  score_by_file(driver, balls.folder.path / "m.h5");
  const auto model = driver.state().scoring.of_file;
  Points points = *driver.document().view()->shape.points;
  const VertexScalars lying = test::must(score_shape(*model, points)).z;
  points.col(0) *= -1;
  const VertexScalars flipped = test::must(score_shape(*model, points)).z;
  REQUIRE((lying - flipped).cwiseAbs().maxCoeff() > 0.5);
  const auto shows = [&](const VertexScalars& z) {
    return driver.state().scoring.z != nullptr && (*driver.state().scoring.z - z).cwiseAbs().maxCoeff() < 1e-9;
  };
  driver.wait_until("it is scored flipped", [&] { return shows(flipped); });
  open(false, "lying.study.json");
  driver.wait_until("it is scored as it lies", [&] { return shows(lying); });
}

TEST_CASE("a case that is opened again is scored against the model that it was left with") {
  const ScoredBalls balls;
  const fs::path kept = balls.folder.path / "kept.homolog";
  {
    Driver driver(balls.document, {1280, 2400, 1});
    driver.app().send(SaveCaseAs{{kept}});
    driver.wait_until("it is saved", [&] { return driver.case_file() == kept; });
    score_by_file(driver, balls.folder.path / "m.h5");
    driver.press('Q', {.ctrl = true});
    driver.settle();
    CHECK(driver.app().wants_to_quit());
  }
  Driver driver(new_document({}, nullptr, nullptr), {1280, 2400, 1});
  driver.app().send(OpenFiles{{kept}});
  driver.wait_until("the model is read", [&] { return driver.state().scoring.of_file != nullptr; });
  driver.settle();
  CHECK(driver.state().scoring.by_file);
  CHECK(driver.state().scoring.file == balls.folder.path / "m.h5");
}

}  // namespace homolog
