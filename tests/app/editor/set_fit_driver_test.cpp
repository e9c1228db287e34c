#include <doctest/doctest.h>

#include "core/base/files/files.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/voxels/label_map.h"
#include "core/structures/template_set.h"
#include "core/volume/volume_io.h"
#include "tests/driver.h"
#include "tests/must.h"
#include "tests/stones_on_disk.h"

// A template set fitted to a label map in the window: several structures come into the case.

namespace homolog {

namespace {

Mesh ball_at(double x_mm) {
  Mesh ball = icosphere(3, 20);
  ball.points.col(0).array() += x_mm;
  return ball;
}

/// Two balls side by side: a label map with the values 3 and 5, an image of the same grid, and a set of their
/// templates, which lie elsewhere.
struct TwoBalls {
  TemporaryFolder folder;
  std::filesystem::path labels = folder.path / "labels.nii.gz", set = folder.path / "balls.set.json";
  Document document;

  TwoBalls() {
    VolumeGeometry grid;
    grid.dims = {60, 30, 30};
    grid.spacing_mm.setConstant(2);
    grid.origin_mm = Vec3(-31, -29, -29);
    Volume map = label_map(ball_at(0), grid, 3);
    const Volume second = label_map(ball_at(50), grid, 5);
    auto& voxels = std::get<std::vector<std::uint8_t>>(map.data);
    const auto& further = std::get<std::vector<std::uint8_t>>(second.data);
    for (std::size_t i = 0; i < voxels.size(); ++i)
      if (further[i] != 0) voxels[i] = further[i];
    REQUIRE(write_volume(map, labels));
    TemplateSet balls;
    for (const auto& [name, value, x_mm] : {std::tuple("right ball", 3, 7.0), std::tuple("left ball", 5, 51.0)}) {
      TemplateOfSet one;
      one.name = name;
      one.value = value;
      one.file = folder.path / (std::string(name) + ".ply");
      REQUIRE(write_mesh(ball_at(x_mm), one.file));
      balls.structures.push_back(std::move(one));
    }
    REQUIRE(write_template_set(balls, set));
    document = new_document(labels.string(), std::make_shared<const Volume>(map), nullptr);
  }
};

void fit_two_balls(Driver& driver, const TwoBalls& balls) {
  driver.app().send(open_labels(balls.labels));
  driver.settle();
  driver.app().send(ChooseSet{balls.set.string()});
  driver.wait_until("the set is read", [&] { return driver.state().automatic.set != nullptr; });
  driver.settle();
}

/// How far the farthest vertex lies from the surface of a ball.
double off_ball_mm(const Document& document, std::size_t structure, double x_mm) {
  const Points& points = *document.structures[structure]->shape(0)->points;
  const Eigen::RowVector3d middle(x_mm, 0, 0);
  const Eigen::VectorXd from_middle = (points.rowwise() - middle).rowwise().norm();
  return (from_middle.array() - 20).abs().maxCoeff();
}

}  // namespace

TEST_CASE("the labels of a map are a list before anything is fitted, with a choice and an eye each") {
  const TwoBalls balls;
  Driver driver(balls.document);
  REQUIRE(write_whole_file(balls.folder.path / "labels.json", R"({"3": "right ball", "5": "left ball"})"));
  driver.app().send(open_labels(balls.labels));
  driver.settle();
  REQUIRE(driver.has("right ball (3)/right ball (3)"));
  REQUIRE(driver.has("left ball (5)/left ball (5)"));
  CHECK(driver.state().look.hidden_labels == nullptr);
  driver.click("left ball (5)/left ball (5)");
  CHECK(driver.state().automatic.fit_settings.label == 5);
  driver.click("right ball (3)/eye");
  REQUIRE(driver.state().look.hidden_labels);
  CHECK(*driver.state().look.hidden_labels == std::set<int>{3});
  driver.click("right ball (3)/eye");
  CHECK(driver.state().look.hidden_labels == nullptr);
  driver.click("Only this");
  CHECK(*driver.state().look.hidden_labels == std::set<int>{3});
  driver.click("Show none");
  CHECK(driver.state().look.hidden_labels->size() == 2);
  driver.app().send(FilterStructures{"right"});
  driver.settle();
  CHECK_FALSE(driver.has("left ball (5)/left ball (5)"));
  driver.click("Show all");
  CHECK(*driver.state().look.hidden_labels == std::set<int>{5});
  // Another map begins with all eyes open.
  driver.app().send(open_labels(balls.labels));
  driver.settle();
  CHECK(driver.state().look.hidden_labels == nullptr);
}

TEST_CASE("the window fits a set and one undo takes all of its structures back") {
  const TwoBalls balls;
  Driver driver(balls.document, {1280, 1400, 1});
  fit_two_balls(driver, balls);
  CHECK(driver.shows("2 of 2"));
  driver.click("Fit the set");
  driver.wait_until("the set is fitted", [&] { return driver.document().structures.size() == 2; });
  driver.settle();
  const Document& document = driver.document();
  CHECK(document.structures[0]->name == "right ball");
  CHECK(document.structures[1]->name == "left ball");
  CHECK(document.structures[1]->label == "left ball");
  CHECK(off_ball_mm(document, 0, 0) < 1.2);  // of voxels of 2 mm
  CHECK(off_ball_mm(document, 1, 50) < 1.2);
  for (const auto& one : document.structures) CHECK(one->confidence > 0.5);
  CHECK(driver.has("left ball/left ball"));
  CHECK(driver.app().snapshot().undo_names == std::vector<std::string>{"fit of the set"});
  driver.press('Z', {.ctrl = true});
  driver.settle();
  CHECK(driver.document().structures.empty());
  driver.press('Y', {.ctrl = true});
  driver.settle();
  CHECK(driver.document().structures.size() == 2);
}

TEST_CASE("a set that is opened or dropped is chosen, and what came with it is opened") {
  const TwoBalls balls;
  Driver driver(balls.document);
  driver.app().open({balls.set, balls.labels});
  driver.wait_until("the set is read", [&] { return driver.state().automatic.set != nullptr; });
  driver.settle();
  CHECK(driver.state().automatic.set_source == balls.set.string());
  CHECK(driver.shows("balls.set.json"));
  CHECK(driver.shows("2 of 2"));
  CHECK(driver.document().scan.image != nullptr);
}

TEST_CASE("a label map that is opened by itself is the image and offers its labels") {
  const TwoBalls balls;
  Driver driver(new_document({}, nullptr, nullptr));
  driver.app().open({balls.labels});
  driver.wait_until("the image is open", [&] { return driver.document().scan.image != nullptr; });
  driver.settle();
  CHECK(driver.has("Remove the overlay"));
}

TEST_CASE("a second fit of a set gives its structures new meshes and leaves locked ones alone") {
  const TwoBalls balls;
  Driver driver(balls.document);
  fit_two_balls(driver, balls);
  driver.click("Fit the set");
  driver.wait_until("the set is fitted", [&] { return driver.document().structures.size() == 2; });
  driver.settle();
  const auto move_away = [&](const char* id) {
    driver.app().send(ChooseStructure{id});
    driver.settle();
    const Shape& shape = *driver.document().structure(id)->shape(0);
    const Points moved = shape.points->rowwise() + Eigen::RowVector3d(0, 4, 0);
    driver.app().send(ApplyEdit{SetPoints{FoundBy::fit, std::nullopt, std::make_shared<const Points>(moved)}});
    driver.settle();
  };
  move_away("s1");
  move_away("s2");
  const Points kept = *driver.document().structures[0]->shape(0)->points;
  driver.app().send(LockStructures{{"s1"}, true});
  driver.click("Fit the set");
  driver.wait_until("the set is fitted again", [&] { return driver.shows("1 locked one stayed as it was."); });
  driver.settle();
  CHECK(driver.document().structures.size() == 2);
  CHECK(*driver.document().structures[0]->shape(0)->points == kept);
  CHECK(off_ball_mm(driver.document(), 0, 0) > 3);
  CHECK(off_ball_mm(driver.document(), 1, 50) < 1.2);
}

TEST_CASE("the window repairs a label map: what was missing is proposed, shown beside what was read, and taken back") {
  const StonesOnDisk stones;
  Driver driver(new_document(stones.labels.string(), std::make_shared<const Volume>(stones.map.volume), nullptr));
  driver.app().send(open_labels(stones.labels));
  driver.settle();
  driver.app().send(ChooseSet{stones.set.string()});
  driver.wait_until("the set is read", [&] { return driver.state().automatic.set != nullptr; });
  driver.settle();
  driver.click("Repair and fit");
  driver.wait_until("the set is fitted", [&] { return driver.document().structures.size() == 5; });
  driver.settle();
  CHECK(driver.shows("something was found in 2"));
  const auto id_of = [&](int k) {
    for (const auto& one : driver.document().structures)
      if (one->name == name_of_stone(k)) return one->id;
    return std::string();
  };
  CHECK(driver.document().structure(id_of(2))->doubt == "Found: missing.");
  CHECK(driver.document().structure(id_of(3))->doubt == "Found: hole.");
  CHECK(driver.document().structure(id_of(1))->doubt.empty());
  const auto& as_read = driver.state().look.structures.as_read;
  CHECK(as_read.size() == 2);

  // The hole: H shows how it was; its own button gives that back, and undo the proposal again.
  driver.app().send(ChooseStructure{id_of(3)});
  driver.settle();
  CHECK(driver.state().look.structures.as_read_shown);
  driver.press('H');
  driver.settle();
  CHECK_FALSE(driver.state().look.structures.as_read_shown);
  const Points proposed = *driver.document().structure(id_of(3))->shape(0)->points;
  driver.click("Take back");
  driver.settle();
  const Points given_back = *driver.document().structure(id_of(3))->shape(0)->points;
  CHECK((given_back - *as_read.at(id_of(3))).cwiseAbs().maxCoeff() < 1e-3);
  CHECK((given_back - proposed).rowwise().norm().maxCoeff() > 0.05);
  driver.press('Z', {.ctrl = true});
  driver.settle();
  CHECK((*driver.document().structure(id_of(3))->shape(0)->points == proposed));

  // The missing one stays while it is locked, then goes, and comes back.
  driver.app().send(ChooseStructure{id_of(2)});
  driver.app().send(LockStructures{{id_of(2)}, true});
  driver.settle();
  driver.click("Take back");
  driver.settle();
  CHECK(driver.document().structures.size() == 5);
  driver.app().send(LockStructures{{id_of(2)}, false});
  driver.settle();
  driver.click("Take back");
  driver.settle();
  CHECK(driver.document().structures.size() == 4);
  driver.press('Z', {.ctrl = true});
  driver.settle();
  CHECK(driver.document().structures.size() == 5);
}

TEST_CASE("a fit of a set that is stopped leaves the case as it was") {
  const TwoBalls balls;
  Driver driver(balls.document);
  fit_two_balls(driver, balls);
  driver.app().send(FitSet{});
  driver.frame();
  driver.app().send(CancelSetFit{});
  driver.settle();
  CHECK(driver.document().structures.empty());
  CHECK_FALSE(driver.app().snapshot().can_undo);
}

TEST_CASE("a repair names its passes, and all structures wait again as the next one begins") {
  SetFitRows rows(true);
  CHECK(rows.pass() == "Fitting to the map as it is");
  for (const char* name : {"L1", "L2"}) rows.add(name);
  const auto steps = [&] { return std::pair(rows.rows()[0].step, rows.rows()[1].step); };
  using enum SetFitStep;
  rows.tell(0, runs);
  rows.tell(1, runs);
  rows.tell(0, fitted);
  CHECK(rows.pass() == "Fitting to the map as it is");
  rows.tell(1, failed);
  rows.tell(1, runs_again);  // by its neighbours: no pass of its own
  CHECK(rows.pass() == "Fitting to the map as it is");
  rows.tell(1, fitted);
  CHECK(rows.pass() == "Looking for what is wrong");
  rows.tell(1, runs);
  CHECK(steps() == std::pair(waits, runs));
  CHECK(rows.pass() == "Fitting to what is proposed");
  rows.tell(0, runs);
  rows.tell(0, fitted);
  rows.tell(1, fitted);
  rows.tell(7, runs);  // one that the map lacked
  CHECK(steps() == std::pair(fitted, fitted));
  CHECK(rows.pass() == "Fitting to what is proposed");
  CHECK(SetFitRows().pass() == "Fitting the set");
}

}  // namespace homolog
