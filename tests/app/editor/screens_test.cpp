#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <regex>
#include <string>
#include <vector>

#include "app/editor/update/controls.h"
#include "core/base/files/files.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/volume/volume_io.h"
#include "tests/beating_ball.h"
#include "tests/driver.h"
#include "tests/must.h"
#include "tests/organ_scan.h"
#include "tests/screens.h"

// Golden pictures of whole screens, half as large as they are: every section, dialog and mode once. What the layout
// tests cannot see is seen here: colours, icons, what is drawn over what.

namespace homolog {

namespace {

namespace fs = std::filesystem;

constexpr Driver::Size usual{1024, 640, 1};

/// What is another at every run: a time, a folder of the test, a date.
const std::regex& varying() {
  static const std::regex parts(
      R"re([0-9.]+ ms|/tmp\S*|homolog-\S*|20[0-9]{2}-[0-9]{2}-[0-9]{2}\S*|[0-9]{2}:[0-9]{2})re");
  return parts;
}

bool varies(const DrawnItem& item) {
  return std::regex_search(item.name, varying()) || std::regex_search(item.value, varying()) ||
         item.path.ends_with("/timings");
}

/// The sentences of a screen, each number as #: a processor may round otherwise.
std::string sentences(const std::vector<DrawnItem>& items) {
  static const std::regex number("[0-9]+([.,][0-9]+)*");
  std::string all;
  for (const DrawnItem& item : items) {
    if (std::ranges::count(item.name, ' ') < 2) continue;
    const std::string constant = std::regex_replace(item.name, varying(), "*");
    all += std::regex_replace(constant, number, "#") + '\n';
  }
  return all;
}

void check_sentences(const std::vector<DrawnItem>& items, const std::string& name) {
  const fs::path golden = fs::path(HOMOLOG_SOURCE_DIR) / "tests/golden/screens" / (name + ".txt");
  const fs::path drawn = fs::path(HOMOLOG_BINARY_DIR) / "golden/screens" / (name + ".txt");
  const std::string now = sentences(items);
  if (read_whole_file(golden).value_or("") == now) return;
  fs::create_directories(drawn.parent_path());
  REQUIRE(write_whole_file(drawn, now));
  FAIL(name << ": says something else; compare " << drawn.string() << " with " << golden.string());
}

void check_screen(Driver& driver, const std::string& name) {
  driver.settle();
  check_sentences(driver.items(), name);
  const Picture picture = test::halved(driver.picture());
  std::vector<test::PicturePart> parts;
  test::add_items(parts, driver.items(), picture, 2);
  CHECK(parts.size() > 5);
  std::vector<DrawnItem> varying;
  std::ranges::copy_if(driver.items(), std::back_inserter(varying), varies);
  std::vector<test::PicturePart> free;
  test::add_items(free, varying, picture, 2);
  for (test::PicturePart& part : parts)
    for (const test::PicturePart& other : free)
      for (std::size_t i = 0; i < other.pixels.size(); ++i)
        if (other.pixels[i]) part.pixels[i] = false;
  for (test::PicturePart& part : free) part.limit = 1;
  std::erase_if(parts, [](const test::PicturePart& part) { return test::count_of(part.pixels) < 20; });
  parts.insert(parts.end(), free.begin(), free.end());
  test::check_golden(picture, "screens/" + name, parts);
}

/// The case with these sections open and all others closed.
void open_only(Driver& driver, const std::vector<std::string>& open) {
  for (const char* title :
       {"Case", "Cine", "Template", "Place", "Deform", "Correspondence", measurements_section, score_section, "Export"})
    driver.state().preferences.sections_open[title] = std::ranges::find(open, title) != open.end();
}

/// Balls of different length as the open study.
void show_balls(Driver& driver, const fs::path& folder, const std::vector<std::string>& names) {
  std::vector<fs::path> files;
  for (std::size_t k = 0; k < names.size(); ++k) {
    Mesh ball = icosphere(3, 20);
    ball.points.col(2) *= 1 + 0.15 * static_cast<double>(k);
    ball.points.col(0) *= 1 + 0.1 * static_cast<double>(k * k % 3);
    files.push_back(folder / (names[k] + ".ply"));
    REQUIRE(write_mesh(ball, files.back()));
  }
  driver.state().models.shown = true;
  driver.app().send(AddCases{files});
  driver.wait_until("the model is made", [&] { return driver.state().models.made.model != nullptr; });
  driver.settle();
  driver.state().notices.clear();
}

}  // namespace

TEST_CASE("golden pictures of the sections") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  const OrganScan scan;
  Driver driver(scan.document(), usual);
  for (const char* title : {"Case", "Template", "Place", "Deform", "Correspondence", "Export"}) {
    open_only(driver, {title});
    std::string name = title;
    name[0] = static_cast<char>(std::tolower(name[0]));
    check_screen(driver, "section_" + name);
  }
}

TEST_CASE("golden picture of measurements in the panel and on the mesh") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  Driver driver(new_document("", nullptr, test::must(load_template(built_in_source(Organ::vertebra)))), usual);
  open_only(driver, {measurements_section});
  driver.settle();  // the recipe of the template is read
  for (const char* name : {"anterior height", "endplate angle", "canal width"})
    driver.app().send(DrawMeasurement{name, true});
  check_screen(driver, "section_measurements");
}

TEST_CASE("golden picture of a score in the panel and on the mesh") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  Driver driver(new_document("", nullptr, test::must(load_template(built_in_source(Organ::kidney)))), usual);
  driver.app().send(OpenPhantomStudy{Organ::kidney});
  driver.wait_until("the study has a model", [&] { return driver.state().models.shapes.fitted.model != nullptr; });
  driver.state().models.shown = false;
  driver.state().notices.clear();
  open_only(driver, {score_section});
  driver.app().send(ChooseColouring{Colouring::score});
  driver.wait_until("it is scored", [&] { return driver.state().scoring.z != nullptr; });
  check_screen(driver, "section_score");
}

TEST_CASE("golden picture of the section of a cine") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  Driver driver(BeatingBall::document(), usual);
  driver.app().send(PropagateFrames{});
  driver.wait_until("every frame has a mesh",
                    [&] { return driver.state().found.volume_curve.frames.size() == BeatingBall::frames; });
  driver.state().notices.clear();
  open_only(driver, {"Cine"});
  check_screen(driver, "section_cine");
}

TEST_CASE("golden pictures of landmarks and a snap and what is confirmed") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  const OrganScan scan;
  Driver driver(scan.document(), usual);
  driver.app().send(ApplyEdit{PlaceLandmark{"upper end", Vec3(0, 0, 22)}});
  driver.app().send(ApplyEdit{PlaceLandmark{"hilum", Vec3(-18, 0, -11)}});
  driver.app().send(SnapMesh{});
  driver.wait_until("the mesh has snapped", [&] { return driver.state().found.snapped.has_value(); });
  driver.app().send(ApplyEdit{Confirm{Vec3(0, -22, 0), 12, true}});
  driver.settle();
  open_only(driver, {"Deform"});
  check_screen(driver, "snapped");
}

TEST_CASE("golden pictures of small and large and light windows") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  const OrganScan scan;
  {
    Driver driver(scan.document(), {800, 600, 1});
    check_screen(driver, "smallest");
  }
  {
    Driver driver(scan.document(), {1600, 1200, 2});
    check_screen(driver, "scale_2");
  }
  Driver driver(scan.document(), usual);
  driver.app().send(UseLightTheme{true});
  check_screen(driver, "light");
}

TEST_CASE("golden pictures of the looks of the slices in 3D") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  const OrganScan scan;
  Driver driver(scan.document(), {640, 600, 1});
  driver.state().preferences.panel_open = false;
  driver.state().look.maximised = ViewKind::space;
  driver.state().preferences.show.glyphs = true;
  for (const auto& [look, name] :
       {std::pair(PlaneLook::behind, "slices_behind"), std::pair(PlaneLook::solid, "slices_solid")}) {
    driver.state().preferences.show.plane_look = look;
    check_screen(driver, name);
  }
}

TEST_CASE("golden pictures of dialogs and menus") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  const OrganScan scan;
  Driver driver(scan.document(), {800, 600, 1});
  const fs::path files = scan.folder.path / "files";
  fs::create_directory(files);
  fs::create_directory(files / "followup");
  for (const char* name : {"baseline.nii", "organ.ply"}) std::ofstream(files / name) << "x";
  driver.state().preferences.folder = files;
  driver.app().send(ApplyEdit{SetStiffnessBase{7}});
  driver.app().send(ApplyEdit{Confirm{Vec3(0, 0, 20), 8, true}});
  driver.settle();
  driver.click("top bar/history");
  check_screen(driver, "menu");
  driver.press(key::escape);
  driver.press(key::f1);
  check_screen(driver, "help");
  driver.press(key::escape);
  driver.app().send(ShowFileDialog{FilePurpose::open, {}});
  driver.settle();
  std::get<FileDialog>(*driver.state().dialog).browser.places = {{"Home", "/home/someone"}, {"Root", "/"}};
  check_screen(driver, "files");
  driver.state().dialog = QuitDialog{};
  check_screen(driver, "question");
}

TEST_CASE("golden pictures of the guide and of what the keys have reached") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  const OrganScan scan;
  Driver driver(scan.document(), usual);
  driver.state().guide = guide_to(driver.document().view()->mesh(), 1.2 * *driver.document().view()->shape.points);
  check_screen(driver, "guide");
  driver.state().guide.reset();
  driver.go_to("top bar/Outlines of the mesh in the slices (O)");
  check_screen(driver, "keys");
}

TEST_CASE("golden pictures of long names and of names in East Asian letters") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  const OrganScan scan;
  std::string longest;
  for (int k = 0; k < 6; ++k) longest += "a very long name ";
  {
    Driver driver(scan.document({longest + "1", longest + "2"}, longest + ".ply"), {800, 600, 1});
    open_only(driver, {"Template", "Place"});
    check_screen(driver, "long_names");
  }
  if (!fs::exists("/usr/share/fonts/truetype/droid/DroidSansFallbackFull.ttf"))
    return test::skip("the Debian package fonts-droid-fallback is not installed");
  // The font of the picture, whatever others there are.
  fs::create_directories(scan.folder.path / "fonts/truetype");
  fs::create_directory_symlink("/usr/share/fonts/truetype/droid", scan.folder.path / "fonts/truetype/droid");
  const EnvironmentVariable only_these("XDG_DATA_DIRS", scan.folder.path);
  Driver driver(scan.document({"\xe8\x85\x8e\xe8\x87\x93\xe4\xb8\x8a\xe6\xa5\xb5", "\xe8\x85\x8e\xe9\x96\x80"},
                              "\xe8\x85\x8e\xe8\x87\x93.ply"),
                {800, 600, 1});
  open_only(driver, {"Template", "Place"});
  driver.frames(3);  // the letters are looked for when they are met
  check_screen(driver, "east_asian_names");
}

TEST_CASE("golden pictures of the gallery and the worklist") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  const OrganScan scan;
  {
    Driver driver(scan.document(), usual);
    show_balls(driver, scan.folder.path, {"anna", "bert", "carl", "dora"});
    driver.app().send(SelectCase{"bert"});
    check_screen(driver, "gallery");
    driver.app().send(UseLightTheme{true});
    check_screen(driver, "gallery_light");
  }
  Driver driver(scan.document(), {800, 600, 1});
  show_balls(driver, scan.folder.path, {"anna", "bert"});
  for (const char* name : {"scan-1.nii", "scan-2.nii"}) {
    REQUIRE(write_volume(label_map(icosphere(3, 18), OrganScan::grid(), 1), scan.folder.path / name));
    driver.app().send(AddScans{{scan.folder.path / name}});
    driver.settle();
  }
  driver.state().notices.clear();
  check_screen(driver, "worklist");
}

TEST_CASE("golden picture of optimised shapes") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  const OrganScan scan;
  Driver driver(scan.document(), {1024, 860, 1});
  show_balls(driver, scan.folder.path, {"anna", "bert", "carl", "dora"});
  for (const char* title : {"Model", "Measures", "To check"}) driver.state().preferences.sections_open[title] = false;
  driver.state().preferences.sections_open["Optimise"] = true;
  // Figures of the test's own, which are the same on every machine.
  ModelsState& models = driver.state().models;
  models.made.optimisation.of =
      std::make_shared<const StudyToOptimise>(StudyToOptimise{models.shapes.fitted, models.made.alignment});
  for (int round = 0; round <= 20; ++round) models.made.optimisation.bits.push_back(9 + 0.5 * std::exp(-0.3 * round));
  take_optimised(models,
                 {models.shapes.fitted, {9.5, 4, 2, 0.981, 1.608, 1.283}, {9, 4, 2, 0.984, 1.555, 1.251}, 1.23, 0.2});
  check_screen(driver, "optimised");
}

}  // namespace homolog
