#include <doctest/doctest.h>

#include <algorithm>
#include <map>

#include "app/editor/update/file_purposes.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/session/case_file.h"
#include "core/volume/volume_io.h"
#include "tests/ball.h"
#include "tests/driver.h"
#include "tests/must.h"

// What a person chooses for several cases at once: files in the dialog, and the label of a worklist's maps.

namespace homolog {

namespace {

namespace fs = std::filesystem;

VolumeGeometry map_grid() {
  VolumeGeometry grid;
  grid.dims = {60, 60, 60};
  grid.origin_mm.setConstant(-29.5);
  return grid;
}

/// Label 1 is a ball of 8 mm aside, label 2 one of `radius_mm` in the middle; 0: there is none.
void write_two_labels(const fs::path& file, double radius_mm) {
  Mesh aside = icosphere(3, 8);
  aside.points.rowwise() += Eigen::RowVector3d(19, 19, 19);
  Volume map = label_map(aside, map_grid(), 1);
  if (radius_mm > 0) {
    const Volume ball = label_map(icosphere(4, radius_mm), map_grid(), 2);
    auto& voxels = std::get<std::vector<std::uint8_t>>(map.data);
    const auto& others = std::get<std::vector<std::uint8_t>>(ball.data);
    for (std::size_t v = 0; v < voxels.size(); ++v) voxels[v] = std::max(voxels[v], others[v]);
  }
  REQUIRE(write_volume(map, file));
}

double height_of(const fs::path& case_file) {
  return bounds_of(*test::must(read_case(case_file)).session.document().view()->shape.points).sizes().z();
}

std::vector<std::string> names_of_cases(Driver& driver) {
  std::vector<std::string> names;
  for (const StudyCase& one : driver.state().models.study.cases) names.push_back(one.name);
  return names;
}

/// A case of a ball that is read from a file, as what is opened again must be.
Document ball_of_file(const TemporaryFolder& folder) {
  const fs::path file = folder.path / "ball.ply";
  REQUIRE(write_mesh(icosphere(3, 20), file));
  return new_document("", nullptr, test::must(load_template(file.string())));
}

/// The folder that the open dialog shows.
void go_to_folder(Driver& driver, const fs::path& folder) {
  driver.type_into("name", folder.string());
  driver.press(key::enter);
  driver.settle();
}

const FileBrowser& browser_of(Driver& driver) {
  return std::get<FileDialog>(*driver.state().dialog).browser;
}

}  // namespace

TEST_CASE("where maps hold several labels one is asked for and fitted in every case that waits") {
  const TemporaryFolder folder;
  const fs::path scans = folder.path / "scans";
  fs::create_directory(scans);
  write_two_labels(scans / "a.nii", 15);
  write_two_labels(scans / "b.nii", 20);
  write_two_labels(scans / "c.nii", 0);  // one label only: there is nothing to choose
  Driver driver(ball_of_file(folder));
  driver.press(key::tab);
  driver.app().send(AddScans{{scans}});
  driver.wait_until("the scans are cases", [&] { return driver.state().models.study.cases.size() == 3; });
  driver.settle();
  driver.click("Fit waiting (3)");
  driver.wait_until("it is asked", [&] { return driver.has("All labels together"); });
  CHECK(waiting_cases(driver.state().models) == 3);
  CHECK(driver.shows("a.nii holds 2 labels"));
  driver.settle();
  driver.click("Label 2");
  CHECK_FALSE(driver.state().dialog);
  CHECK(driver.shows("Label 2 is fitted where a map holds several."));
  driver.wait_until("all are fitted", [&] { return waiting_cases(driver.state().models) == 0; });
  driver.settle();
  for (const auto& [name, height_mm] : std::map<std::string, double>{{"a", 30}, {"b", 40}, {"c", 16}}) {
    CAPTURE(name);
    const StudyCase* one = find_case(driver.state().models.study, name);
    REQUIRE(one != nullptr);
    CHECK(height_of(one->file) == doctest::Approx(height_mm).epsilon(0.1));
  }
}

TEST_CASE("with Ctrl and Shift several files are chosen and a worklist takes just those") {
  const TemporaryFolder folder;
  for (const char* name : {"anna", "bert", "carl", "dora"}) {
    REQUIRE(write_mesh(icosphere(2, 20), folder.path / (std::string(name) + ".ply")));
    REQUIRE(write_volume(label_map(icosphere(2, 12), map_grid(), 1), folder.path / (std::string(name) + ".nii")));
  }
  const fs::path files = folder.path;
  Driver driver(new_document("", nullptr, ball_template(20)));
  driver.press(key::tab);
  driver.click("Meshes…");
  go_to_folder(driver, files);
  driver.click("anna.ply/row");
  driver.hold_keys({false, true, false});
  driver.click("carl.ply/row");
  driver.click("dora.ply/row");
  driver.click("dora.ply/row");  // and not, after all
  driver.hold_keys({});
  driver.click("Add 2");
  driver.settle();
  CHECK(names_of_cases(driver) == std::vector<std::string>{"anna", "carl"});

  driver.click("Scans…");
  go_to_folder(driver, files);
  driver.click("anna.nii/row");
  driver.hold_keys({true, false, false});
  driver.click("carl.nii/row");
  driver.hold_keys({});
  driver.press(key::down, {true, false, false});  // Shift with an arrow: one more
  CHECK(driver.has("Add 4"));
  driver.click("bert.nii/row");  // alone again
  CHECK_FALSE(driver.has("Add 4"));
  driver.press(key::down, {true, false, false});
  driver.click("Add 2");
  driver.wait_until("the scans are cases", [&] { return driver.state().models.study.cases.size() == 4; });
  driver.settle();
  CHECK(names_of_cases(driver) == std::vector<std::string>{"anna", "carl", "bert", "carl-2"});
}

TEST_CASE("while a path is typed the folder that it leads to is listed") {
  Driver driver(new_document("", nullptr, ball_template(20)));
  const fs::path inner = driver.folder() / "inner";
  fs::create_directory(inner);
  for (const char* name : {"a_carl.ply", "carl.ply", "dora.ply"})
    REQUIRE(write_mesh(icosphere(2, name[0] == 'c' ? 15 : 20), inner / name));
  const auto type = [&](const fs::path& path) {
    driver.type_into("name", path.string());
    driver.settle();
  };
  driver.app().send(ShowFileDialog{FilePurpose::open_template, ""});
  driver.settle();
  type(inner / "");
  CHECK_FALSE(driver.shows("No match."));
  CHECK(driver.has("dora.ply/row"));
  CHECK(browser_of(driver).listed_folder() == inner);
  type(inner / "car");
  CHECK_FALSE(driver.has("dora.ply/row"));
  type(driver.folder() / "nowhere" / "x");
  CHECK(driver.shows("There is no folder " + (driver.folder() / "nowhere").string()));
  type("nothing of this name");
  CHECK(driver.shows("No match."));
  type(inner / "carl.ply");
  driver.press(key::enter);  // the file of that name and not the first that holds it
  driver.wait_until("the template is open", [&] {
    return driver.document().structure()->the_template->source == (inner / "carl.ply").string();
  });
  driver.settle();

  driver.app().send(ShowFileDialog{FilePurpose::export_mesh, "out.ply"});
  driver.settle();
  type(inner / "new.ply");
  CHECK(driver.has("dora.ply/row"));
  driver.click("dora.ply/row");
  CHECK(browser_of(driver).folder == inner);
  CHECK(browser_of(driver).name == "dora.ply");
}

TEST_CASE("a folder that is chosen in a dialog is entered by its button whatever the dialog is for") {
  Driver driver(new_document("", nullptr, ball_template(20)));
  const fs::path inner = driver.folder() / "inner";
  fs::create_directory(inner);
  for (const FilePurpose purpose : {FilePurpose::open, FilePurpose::open_template, FilePurpose::add_scans,
                                    FilePurpose::add_shapes, FilePurpose::export_mesh}) {
    driver.app().send(ShowFileDialog{purpose, purpose == FilePurpose::export_mesh ? "a.ply" : ""});
    driver.settle();
    driver.click("inner/row");
    const std::string title = file_purpose(purpose).title;
    driver.click(title + "/Open");
    CHECK(browser_of(driver).folder == inner);
    driver.press(key::escape);
  }
}

TEST_CASE("a case that was not saved is recovered by a click on its row and only one button stands beside it") {
  const TemporaryFolder folder;
  const fs::path journal = folder.path / "gone.homolog";
  REQUIRE(create_case(ball_of_file(folder), journal));
  Driver driver(new_document({}, nullptr, nullptr));
  driver.state().dialog = RecoverDialog{{{journal, "ct.nii", "12 edits"}}, {}};
  driver.settle();
  std::size_t buttons = 0;
  for (const DrawnItem& item : driver.items())
    buttons += item.kind == DrawnItem::Kind::button && item.path.find("gone.homolog") != std::string::npos;
  CHECK(buttons == 1);
  driver.click("gone.homolog/Recover");
  driver.wait_until("the case is open", [&] { return driver.case_file() == journal; });
}

}  // namespace homolog
