#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include "app/editor/update/file_purposes.h"
#include "app/editor/update/keys.h"
#include "core/base/files/files.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/files/landmark_io.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/volume/volume_io.h"
#include "tests/driver.h"
#include "tests/must.h"
#include "tests/small_files.h"

// Commands: each has a line, and the lines of a session lead to its case again.

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// A ball of 40 mm as a template, and a label map of one of 37 mm.
struct BallAndLabel {
  TemporaryFolder folder;
  fs::path label = folder.path / "label.nii.gz", landmarks = folder.path / "placed.mrk.json";
  Document document;

  BallAndLabel() {
    const Mesh mesh = icosphere(3, 40);
    MeshFile ball{mesh.points, mesh.topology->triangles()};
    ball.landmarks = {{"north", Vec3(0, 0, 40)}, {"south", Vec3(0, 0, -40)}};
    const fs::path file = folder.path / "ball.ply";
    REQUIRE(write_mesh_file(ball, file));
    document = new_document("", nullptr, test::must(load_template(file.string())));
    VolumeGeometry grid;
    grid.dims = {60, 60, 60};
    grid.spacing_mm.setConstant(1.5);
    grid.origin_mm.setConstant(-44);
    REQUIRE(write_volume(label_map(icosphere(4, 37), grid, 1), label));
    REQUIRE(write_landmarks({{"north", Vec3(0, 0, 37)}}, landmarks));
  }
};

void open_by_dialog(Driver& driver, std::string_view button, const fs::path& file) {
  driver.click(button);
  driver.type_into("name", file.string());
  driver.press(key::enter);
}

template <class... Listed>
std::vector<Command> one_of_each(TypeList<Listed...>) {
  return {Listed{}...};
}

std::vector<Command> one_of_each() {
  return one_of_each(AllCommands());
}

}  // namespace

TEST_CASE("a fit to the label is said as long as the mesh is as it left it") {
  const BallAndLabel ball;
  Driver driver(ball.document);
  driver.click("side panel/Place");
  open_by_dialog(driver, "Place/Open a label map…", ball.label);
  driver.wait_until("the label map is open", [&] {
    return driver.has("Place/Fit to the label") && driver.control("Place/Fit to the label").enabled;
  });
  driver.click("Place/Fit to the label");
  driver.wait_until("the fit is done", [&] { return driver.document().view()->shape.points->row(0).norm() < 38.5; });
  driver.settle();
  CHECK(driver.shows("Distance to the label"));
  // A fit that is stopped, by either key or by the button, takes nothing back and leaves the figures of the last one.
  const Document fitted = driver.document();
  const auto undo_names = driver.app().snapshot().undo_names;
  for (int way = 0; way < 3; ++way) {
    CAPTURE(way);
    driver.click("Place/Fit to the label");
    if (way == 0)
      driver.press('Z', {false, true, false});
    else if (way == 1)
      driver.press(key::escape);
    else
      driver.click("top bar/undo");
    driver.settle();
    CHECK(bool(*driver.document().view()->shape.points == *fitted.view()->shape.points));
    CHECK(driver.app().snapshot().undo_names == undo_names);
    CHECK(driver.shows("Distance to the label"));
  }
  driver.click("top bar/undo");
  driver.settle();
  CHECK_FALSE(driver.shows("Distance to the label"));
}

TEST_CASE("the commands of a session lead to the same case again") {
  const BallAndLabel ball;
  const fs::path log = ball.folder.path / "session.log";
  Document before;
  std::vector<std::string> undo_names;
  {
    Driver driver(ball.document);
    REQUIRE(driver.app().log().write_to(log));
    driver.click("side panel/Template");
    driver.type_into("new region", "pole");
    driver.click("Template/Add");
    driver.settle();
    driver.click("side panel/Template");
    driver.click("side panel/Place");
    open_by_dialog(driver, "Place/Import…", ball.landmarks);
    driver.wait_until("the landmark is placed",
                      [&] { return driver.document().view()->shape.landmarks.contains("north"); });
    open_by_dialog(driver, "Place/Open a label map…", ball.label);
    driver.wait_until("the label map is open", [&] {
      return driver.has("Place/Fit to the label") && driver.control("Place/Fit to the label").enabled;
    });
    driver.click("Place/Fit to the label");
    driver.wait_until("the fit is done", [&] { return driver.document().view()->shape.points->row(0).norm() < 38.5; });
    // A fit that is given up leaves nothing, in the case or in the log.
    driver.click("Place/Fit to the label");
    driver.app().send(CancelFit{});
    driver.settle();
    const Vec3 at = driver.document().view()->shape.points->row(5);
    driver.app().send(ApplyEdit{Stroke{Tool::pull, at, 1.1 * at, 12}});
    driver.app().send(ApplyEdit{Stroke{Tool::pull, -at, -1.1 * at, 12}});
    driver.settle();
    driver.click("top bar/undo");
    driver.settle();
    before = driver.document();
    undo_names = driver.app().snapshot().undo_names;
  }
  Driver again(ball.document);
  again.app().replay(test::must(read_log(log)));
  again.settle();
  CHECK(bool(*again.document().view()->shape.points == *before.view()->shape.points));
  CHECK(again.document().view()->shape.landmarks == before.view()->shape.landmarks);
  CHECK(again.document().structure()->paint.regions->list.size() == before.structure()->paint.regions->list.size());
  CHECK(again.app().snapshot().undo_names == undo_names);
  CHECK(again.app().snapshot().can_redo);
}

TEST_CASE("the history lists the steps by name and a click goes there") {
  const BallAndLabel ball;
  Driver driver(ball.document);
  const Vec3 pole = driver.document().view()->shape.points->row(5);
  const Points before = *driver.document().view()->shape.points;
  driver.app().send(ApplyEdit{Stroke{Tool::pull, pole, 1.1 * pole, 12}});
  driver.settle();
  const Points pulled = *driver.document().view()->shape.points;
  driver.app().send(ApplyEdit{Confirm{pole, 10, true}});
  driver.app().send(ApplyEdit{SetStiffnessBase{3}});
  driver.settle();
  const auto names = driver.app().snapshot().undo_names;
  REQUIRE(names.size() == 3);
  CHECK(names[1].starts_with("confirm 10 mm, "));
  CHECK(names[2].starts_with("pull "));
  driver.click("top bar/history");
  driver.click("history/Undo: " + names[1]);
  driver.wait_until("two steps are taken back", [&] { return driver.app().snapshot().redo_names.size() == 2; });
  CHECK(bool(*driver.document().view()->shape.points == pulled));
  CHECK(driver.document().view()->shape.confirmed == nullptr);
  driver.settle();
  CHECK(driver.shows("Undone: " + names[1] + "."));
  driver.click("top bar/history");
  driver.click("history/Undo: " + names[2]);
  driver.wait_until("nothing is left to undo", [&] { return !driver.app().snapshot().can_undo; });
  CHECK(bool(*driver.document().view()->shape.points == before));
  driver.click("top bar/history");
  driver.click("history/Redo: stiffness");
  driver.wait_until("all is done again", [&] { return !driver.app().snapshot().can_redo; });
  CHECK(driver.document().structure()->paint.base == 3);
}

TEST_CASE("a click on a fault's figure goes to the fault and the mark goes when it is mended") {
  const BallAndLabel ball;
  Driver driver(ball.document);
  const Vec3 pole = driver.document().view()->shape.points->row(5);
  auto points = std::make_shared<Points>(*driver.document().view()->shape.points);
  points->row(5) = -1.3 * pole.transpose();
  SetPoints broken;
  broken.points = points;
  driver.app().send(ApplyEdit{broken});
  driver.settle();
  driver.wait_until("the fault is measured", [&] { return driver.has("Correspondence/Intersecting pairs"); });
  driver.click("Correspondence/Intersecting pairs");
  driver.settle();
  REQUIRE(driver.app().state().found.finding);
  CHECK(driver.app().state().found.finding->finding.kind == FindingKind::intersecting);
  CHECK((driver.app().state().look.crosshair_mm - driver.app().state().look.camera.target).norm() == 0);
  driver.press('J');
  driver.settle();
  CHECK(driver.app().state().found.finding);
  driver.click("top bar/undo");
  driver.wait_until("the mark is gone", [&] { return !driver.app().state().found.finding.has_value(); });
}

TEST_CASE("no command needs anything to be open") {
  const TemporaryFolder here;  // a command without a path writes where the program was started
  const InFolder in_it(here.path);
  Driver driver(new_document({}, nullptr, nullptr));
  for (const bool in_models : {false, true}) {
    driver.app().send(ShowModels{in_models});
    for (const Command& command : one_of_each()) {
      CAPTURE(log_line(command));
      driver.app().send(command);
      driver.frames(2);
      driver.state().dialog.reset();
      driver.state().notices.clear();
      driver.state().quitting = Quitting::no;
    }
    driver.settle();
  }
  CHECK(driver.shows("Models"));
}

TEST_CASE("every command has a key of its own and its line reads back as it was") {
  std::set<std::string> keys;
  for (const Command& command : one_of_each()) {
    const std::string line = log_line(command);
    CAPTURE(line);
    const auto read = command_of_line(line);
    REQUIRE(read);
    CHECK(std::string(read->key()) == command.key());
    CHECK(log_line(*read) == line);
    CHECK(keys.insert(command.key()).second);
    CHECK(command.cancels() == std::string_view(command.key()).starts_with("cancel "));
  }
}

TEST_CASE("a line of the log that is no command is refused by its number") {
  const TemporaryFolder folder;
  const fs::path log = folder.path / "session.log";
  for (const char* bad :
       {"{\"do\":\"dance\"}", "{\"do\":\"choose tool\"}", "{\"do\":\"choose tool\",\"tool\":7}", "no"}) {
    std::ofstream(log) << log_line(ChooseTool{MouseTool::slide}) << '\n' << bad << '\n';
    const auto read = read_log(log);
    REQUIRE_FALSE(read);
    CHECK(read.error().sentence().find("line 2") != std::string::npos);
  }
  CHECK_FALSE(read_log(folder.path / "absent.log"));
  CommandLog over;
  CHECK_FALSE(over.write_to(log));  // what is no log is not written over
  CHECK(over.write_to(folder.path / "new.log"));
}

TEST_CASE("a log is read from a file only, and says once when the disk is full") {
  CHECK_FALSE(read_log("/dev/zero"));
  const TemporaryFolder folder;
  CommandLog log;
  REQUIRE(log.write_to(folder.path / "session.log"));
  log.is_done(ChooseTool{MouseTool::slide});
  CHECK(log.take_fault().empty());
  {
    const SmallFilesOnly full(100);
    for (int k = 0; k < 10; ++k) log.is_done(ChooseTool{MouseTool::slide});
  }
  CHECK(log.take_fault().find("session.log: the log ends here") != std::string::npos);
  CHECK(log.take_fault().empty());
  CHECK(log.lines().size() == 11);
}

TEST_CASE("every purpose of a file has a row and every key is in the page on editing") {
  std::set<std::string> names;
  for (int purpose = 0; purpose <= static_cast<int>(FilePurpose::export_shapes); ++purpose) {
    const FilePurposeKind& kind = file_purpose(static_cast<FilePurpose>(purpose));
    CHECK(kind.purpose == static_cast<FilePurpose>(purpose));
    CHECK(names.insert(kind.name).second);
    CHECK(purpose_of(kind.name) == kind.purpose);
  }
  const std::string page = test::must(read_whole_file(fs::path(HOMOLOG_SOURCE_DIR) / "docs" / "editing.md"));
  for (const bool in_models : {false, true})
    for (const KeyRow& row : key_rows(in_models)) {
      CAPTURE(row.keys);
      CHECK(page.find("| `" + std::string(row.keys) + "` | " + row.does + " |") != std::string::npos);
    }
}

}  // namespace homolog
