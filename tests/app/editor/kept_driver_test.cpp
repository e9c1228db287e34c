#include <doctest/doctest.h>

#include <algorithm>

#include "core/experiment/demo_case.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/formats/formats.h"
#include "core/mesh/mesh_io.h"
#include "core/model/shapes/study.h"
#include "core/volume/volume_io.h"
#include "tests/driver.h"
#include "tests/must.h"
#include "tests/organ_scan.h"

// What the window keeps of what was open before, and what it does not: studies, folders, templates.

namespace homolog {

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> two_balls(const fs::path& folder) {
  fs::create_directories(folder);
  std::vector<fs::path> files;
  for (const char* name : {"one.ply", "two.ply"}) {
    Mesh ball = icosphere(2, 20);
    ball.points.col(0) *= files.empty() ? 1 : 1.1;
    MeshFile file{ball.points, ball.topology->triangles()};
    file.landmarks = {{"north", Vec3(0, 0, 20)}, {"south", Vec3(0, 0, -20)}};
    files.push_back(folder / name);
    REQUIRE(write_mesh_file(file, files.back()));
  }
  return files;
}

const FileBrowser& files_of(Driver& driver) {
  return std::get<FileDialog>(*driver.state().dialog).browser;
}

void save_to(Driver& driver, const fs::path& file) {
  driver.type_into("name", file.string());
  driver.press(key::enter);
  driver.wait_until("the file is written", [&] { return fs::exists(file); });
  driver.settle();
}

/// A driver in Models with a study that was given no place.
struct UnnamedStudy {
  Driver driver{new_document("", nullptr, nullptr)};
  fs::path file;

  UnnamedStudy() {
    driver.state().models.shown = true;
    driver.app().send(AddCases{two_balls(driver.folder() / "shapes")});
    driver.wait_until("the shapes are cases", [&] { return driver.state().models.shapes.sizes.size() == 2; });
    driver.settle();
    file = driver.state().models.kept.file;
  }
};

}  // namespace

TEST_CASE("a study without a name is offered again when another takes its place and stays in a list") {
  UnnamedStudy unnamed;
  Driver& driver = unnamed.driver;
  const fs::path other = driver.folder() / "other.study.json";
  REQUIRE(write_study({}, other));
  driver.app().send(OpenStudy{{other}});
  driver.wait_until("the other study is open", [&] { return driver.state().models.kept.file == other; });
  driver.settle();
  CHECK(driver.shows("The study study-1 is kept."));
  driver.click("Open it again");
  driver.wait_until("the first study is open", [&] { return driver.state().models.kept.file == unnamed.file; });
  driver.settle();
  CHECK(driver.state().models.study.cases.size() == 2);
  CHECK_FALSE(driver.shows("is kept."));  // of a study with a place of its own it is not said

  const Preferences& kept = driver.state().preferences;
  CHECK(kept.recent_studies == std::vector<fs::path>{unnamed.file, other});
  driver.click("Study");
  driver.click("study menu/Open study…");
  driver.settle();
  CHECK(driver.shows("study-1"));
  driver.click("recent " + other.string() + "/row");
  driver.wait_until("the study of the list is open", [&] { return driver.state().models.kept.file == other; });
}

TEST_CASE("no file of a study without a place is written where the program keeps its own") {
  UnnamedStudy unnamed;
  Driver& driver = unnamed.driver;
  const fs::path chosen = driver.folder() / "chosen";
  driver.state().preferences.folder = chosen;
  fs::create_directories(chosen / "tables");
  driver.click("models panel/Sizes");
  driver.click("Sizes/Table…");
  CHECK(files_of(driver).folder == chosen);
  save_to(driver, chosen / "tables" / "sizes.csv");
  driver.click("Sizes/Landmarks…");
  CHECK(files_of(driver).folder == chosen / "tables");
  driver.press(key::escape);
  driver.click("Study");
  driver.click("study menu/New study…");
  CHECK(files_of(driver).folder == chosen / "tables");
}

TEST_CASE("files of a case go where the last one went until an image of another folder is opened") {
  const OrganScan scan;
  REQUIRE(write_volume(*OrganScan::image(), scan.folder.path / "scan.nii"));
  Driver driver(scan.document());
  const fs::path out = driver.folder() / "out";
  fs::create_directories(out);
  driver.click("side panel/Export");
  driver.click("Export/Mesh…");
  CHECK(files_of(driver).folder == driver.case_file().parent_path());
  save_to(driver, out / "organ.ply");
  driver.click("Export/Label map…");
  CHECK(files_of(driver).folder == out);
  driver.press(key::escape);
  driver.app().send(OpenFiles{{scan.folder.path / "scan.nii"}});  // beside the image before
  driver.wait_until("the case is another", [&] { return driver.case_file().parent_path() != driver.folder(); });
  driver.settle();
  driver.click("Export/Mesh…");
  CHECK(files_of(driver).folder == out);
  driver.press(key::escape);
  fs::create_directories(driver.folder() / "far");
  fs::copy_file(scan.folder.path / "scan.nii", driver.folder() / "far" / "scan.nii");
  driver.app().send(OpenFiles{{driver.folder() / "far" / "scan.nii"}});
  driver.wait_until("the image is another",
                    [&] { return driver.document().scan.source.find("/far/") != std::string::npos; });
  driver.settle();
  driver.click("Export/Mesh…");
  CHECK(files_of(driver).folder == driver.folder() / "far");
}

TEST_CASE("the template of a demo is not taken into an image of one's own and one that was loaded is") {
  const OrganScan scan;
  const fs::path image = scan.folder.path / "scan.nii";
  REQUIRE(write_volume(*OrganScan::image(), image));
  const auto open_own_image = [&](Driver& driver) {
    driver.app().send(OpenFiles{{image}});
    driver.wait_until("the image is open", [&] { return driver.document().scan.source == image.string(); });
    driver.settle();
  };
  {
    Driver driver(test::must(demo_document(Organ::kidney, 1)));
    open_own_image(driver);
    CHECK(driver.document().structures.empty());
    CHECK(driver.shows("There is no mesh yet. Load a template (Template), or fit a set to a label map (Structures)."));
  }
  Driver driver(new_document("", nullptr, test::must(load_template("built-in:kidney"))));
  open_own_image(driver);
  CHECK(driver.document().view());
}

TEST_CASE("a mesh file that does not keep what a shape model needs says so when it is written") {
  const OrganScan scan;
  Driver driver(scan.document());
  driver.click("side panel/Export");
  const std::string tip = driver.control("Export/Mesh…").tip;
  CHECK(tip.find(" or .particles. Without numbering: .stl. Without faces: .particles") != std::string::npos);
  for (const std::string& kept : mesh_format_extensions(&MeshFormat::keeps_numbers))
    CHECK(tip.find(kept) < tip.find("Without numbering"));
  const auto said_of = [&](const char* name) {
    driver.state().notices.clear();
    driver.click("Export/Mesh…");
    save_to(driver, driver.folder() / name);
    return driver.shows("STL keeps no numbering; use PLY") ? std::string("no numbering")
           : driver.shows("keep the points alone")         ? std::string("no faces")
           : driver.shows(std::string("/") + name + ". ")  ? std::string("something")
                                                           : std::string();
  };
  CHECK(said_of("organ.stl") == "no numbering");
  CHECK(said_of("organ.particles") == "no faces");
  for (const char* name : {"organ.ply", "organ.vtk", "organ.vtp", "organ.obj"}) {
    CAPTURE(name);
    CHECK(said_of(name).empty());
  }
}

}  // namespace homolog
