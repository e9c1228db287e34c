#include <doctest/doctest.h>

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <new>
#include <set>

#include "app/editor/interface/interface.h"
#include "app/editor/update/controls.h"
#include "core/base/files/files.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/files/landmark_io.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/model/shapes/study.h"
#include "core/volume/volume_io.h"
#include "tests/desk.h"
#include "tests/driver.h"
#include "tests/failing_memory.h"
#include "tests/must.h"
#include "tests/screens.h"

// What a person does with the panels, done to the panels themselves: what is asserted is the document, the case's file
// and the screen.

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// A ball of 40 mm as a template, with a region and two landmarks.
struct Ball {
  TemporaryFolder folder;
  fs::path file = folder.path / "ball.ply";

  Ball() {
    const Mesh mesh = icosphere(3, 40);
    MeshFile ball{mesh.points, mesh.topology->triangles()};
    ball.landmarks = {{"north", Vec3(0, 0, 40)}, {"south", Vec3(0, 0, -40)}};
    REQUIRE(write_mesh_file(ball, file));
  }
  Document document() const { return new_document("", nullptr, test::must(load_template(file.string()))); }
};

const Region* region_named(const Document& document, const std::string& name) {
  for (const Region& region : document.structure()->paint.regions->list)
    if (region.name == name) return &region;
  return nullptr;
}

double factor_of(const Driver& driver, const std::string& name) {
  const Region* region = region_named(driver.document(), name);
  return region != nullptr ? region->factor : 0;
}

/// Types a file's name into the file dialog that is open.
void choose(Driver& driver, const fs::path& file) {
  driver.type_into("name", file.string());
  driver.press(key::enter);
}

/// The section Template open, with a region.
void add_region(Driver& driver, const std::string& name) {
  driver.click("side panel/Template");
  driver.type_into("new region", name);
  driver.click("Template/Add");
  driver.wait_until("the region is in the case", [&] { return region_named(driver.document(), name) != nullptr; });
}

}  // namespace

TEST_CASE("a region's factor stays as it was typed or dragged") {
  const Ball ball;
  Driver driver(ball.document());
  add_region(driver, "hilum");
  CHECK(driver.control("hilum/factor").value == "1.0 \xc3\x97");

  driver.type_into("hilum/factor", "8");
  driver.press(key::enter);
  driver.wait_until("8 is in the case", [&] { return factor_of(driver, "hilum") == 8; });
  CHECK(driver.control("hilum/factor").value == "8.0 \xc3\x97");
  CHECK(driver.lines_with("\"factor\":8") == 1);

  driver.type_into("hilum/factor", "5");
  driver.press(key::tab);
  driver.wait_until("5 is in the case", [&] { return factor_of(driver, "hilum") == 5; });
  driver.type_into("hilum/factor", "3");
  driver.click("Template/Import…");  // clicked away: the dialog opens over it
  driver.press(key::escape);
  driver.wait_until("3 is in the case", [&] { return factor_of(driver, "hilum") == 3; });

  driver.hold_and_move("hilum/factor", 60, 0);
  const std::string held = driver.control("hilum/factor").value;
  CHECK(held != "3.0 \xc3\x97");
  driver.wait_until("the preview shows it", [&] { return driver.app().snapshot().preview.has_value(); });
  CHECK(factor_of(driver, "hilum") == 3);
  driver.let_go();
  driver.wait_until("what was held is in the case", [&] { return factor_of(driver, "hilum") != 3; });
  CHECK(driver.control("hilum/factor").value == held);
  CHECK(driver.lines_with("\"region\"") == 5);
}

TEST_CASE("Enter takes a region's name and another one after a double click") {
  const Ball ball;
  Driver driver(ball.document());
  driver.click("side panel/Template");
  driver.type_into("new region", "hilum");
  driver.press(key::enter);
  driver.wait_until("the region is in the case", [&] { return region_named(driver.document(), "hilum") != nullptr; });
  driver.double_click("hilum/hilum");
  driver.wait_until("its name can be typed", [&] { return driver.has("hilum/new name"); });
  driver.press('A', {false, true, false});
  driver.type("lips");
  driver.press(key::enter);
  driver.wait_until("the name is in the case", [&] { return region_named(driver.document(), "lips") != nullptr; });
  CHECK(region_named(driver.document(), "hilum") == nullptr);
}

TEST_CASE("the mesh is exported under the name that was typed and a file that is there only after a question") {
  const Ball ball;
  Driver driver(ball.document());
  driver.click("side panel/Export");
  driver.click("Export/Mesh…");
  CHECK(driver.shows("Export the mesh"));
  const fs::path file = driver.folder() / "out.ply";
  choose(driver, file);
  driver.wait_until("it is said that the file is written", [&] { return driver.shows("Written: " + file.string()); });
  CHECK(test::must(read_mesh(file)).points.isApprox(*driver.document().view()->shape.points, 1e-6));

  fs::resize_file(file, 0);
  driver.click("Export/Mesh…");
  choose(driver, file);
  driver.wait_until("it is asked", [&] { return driver.has("Replace it"); });
  CHECK(fs::file_size(file) == 0);
  driver.click("Replace it");
  driver.settle();
  CHECK(fs::file_size(file) > 0);
  CHECK(test::must(read_mesh(file)).points.rows() == driver.document().view()->shape.points->rows());
}

TEST_CASE("a control that is not possible says why and does nothing") {
  const Ball ball;
  Driver driver(ball.document());
  driver.click("side panel/Export");
  const DrawnItem& label_map = driver.control("Export/Label map…");
  CHECK_FALSE(label_map.enabled);
  CHECK(label_map.tip == "Open an image first.");
  driver.point_at("Export/Label map…");
  driver.button(MouseButton::left, true);
  driver.button(MouseButton::left, false);
  CHECK_FALSE(driver.state().dialog);
  CHECK(driver.shows("Open an image first."));
}

TEST_CASE("landmark files are read beside the window and taken into the case that asked for them") {
  const Ball ball;
  Driver driver(ball.document());
  const fs::path placed = driver.folder() / "placed.mrk.json", on_template = driver.folder() / "template.mrk.json";
  REQUIRE(write_landmarks({{"north", Vec3(0, 0, 45)}, {"nobody", Vec3::Zero()}}, placed));
  REQUIRE(write_landmarks({{"east", Vec3(40, 0, 0)}, {"far", Vec3(400, 0, 0)}}, on_template));
  driver.click("side panel/Place");
  driver.click("Place/Import…");
  choose(driver, placed);
  // First what goes by itself.
  driver.wait_until("what is left out is said", [&] { return driver.shows("1 of 2 points left out"); });
  driver.wait_until("the landmark is placed",
                    [&] { return driver.document().view()->shape.landmarks.contains("north"); });

  driver.click("side panel/Template");
  driver.click("Template/Import…");
  choose(driver, on_template);
  driver.wait_until("the template has it",
                    [&] { return driver.document().structure()->the_template->landmarks.size() == 3; });
  CHECK(driver.shows("far (360 mm)"));

  // Asked for before another case was opened.
  driver.app().send(ImportLandmarks{{placed}});
  driver.app().handle({MouseMove{}});  // does the command, and takes nothing in yet
  driver.app().start_session(EditSession(ball.document()));
  driver.wait_until("that is said", [&] { return driver.shows("another case was opened meanwhile"); });
  CHECK(driver.document().view()->shape.landmarks.empty());
}

TEST_CASE("an edit that is refused while another case opens is told") {
  const Ball ball;
  Driver driver(ball.document());
  driver.app().send(ApplyEdit{SetStiffnessBase{-1}});
  driver.app().handle({MouseMove{}});  // does the command, and takes nothing in yet
  driver.app().start_session(EditSession(ball.document()));
  driver.wait_until("that is said", [&] { return driver.shows("In the case before: "); });
}

TEST_CASE("an edit that is refused while the window closes is told on the terminal") {
  const Ball ball;
  const TemporaryFolder folder;
  const fs::path errors = folder.path / "errors";
  const int terminal = ::dup(STDERR_FILENO), file = ::open(errors.c_str(), O_CREAT | O_WRONLY, 0600);
  REQUIRE(file >= 0);
  ::dup2(file, STDERR_FILENO);
  {
    Driver driver(ball.document());
    driver.app().send(ApplyEdit{SetStiffnessBase{-1}});
    driver.app().handle({MouseMove{}});
  }
  ::dup2(terminal, STDERR_FILENO);
  ::close(terminal);
  ::close(file);
  CHECK(read_whole_file(errors).value().starts_with("homolog: warning: stiffness"));
}

TEST_CASE("a study's file is kept up to date beside the window") {
  const Ball ball;
  Driver driver(ball.document());
  const fs::path study = driver.folder() / "some.study.json";
  driver.press(key::tab);
  driver.click("Study");
  driver.click("study menu/New study…");
  choose(driver, study);
  driver.wait_until("the study is open", [&] { return driver.state().models.kept.file == study; });
  driver.click("Meshes…");
  choose(driver, ball.file);
  driver.wait_until("the case is in the list", [&] { return driver.has("cases/ball/row"); });
  driver.click("cases/ball/row");
  driver.type_into("selected case/group", "round");
  driver.press(key::enter);
  const auto written = [&] { return test::must(read_whole_file(study)); };
  driver.wait_until("the file says so", [&] { return written().find("\"group\": \"round\"") != std::string::npos; });

  // What the file says last is what was done last.
  for (int k = 0; k < 5; ++k) driver.click("cases/ball/state");
  driver.settle();
  CHECK(written().find("\"done\"") != std::string::npos);
  fs::remove(study);
  fs::create_directory(study);
  driver.click("cases/ball/state");
  driver.wait_until("a fault is said", [&] { return driver.shows("some.study.json"); });
}

namespace {

/// The ball as the one case of a study that is open.
fs::path open_study_of(Driver& driver, const Ball& ball) {
  const fs::path study = driver.folder() / "some.study.json";
  driver.app().send(NewStudy{study});
  driver.wait_until("the study is open", [&] { return driver.state().models.kept.file == study; });
  driver.app().send(AddCases{{ball.file}});
  driver.settle();
  return study;
}

}  // namespace

TEST_CASE("a study that could not be written is not lost with another one or with the window") {
  const Ball ball;
  Driver driver(ball.document());
  const fs::path study = open_study_of(driver, ball), other = driver.folder() / "other.study.json";
  REQUIRE(write_study({}, other));
  fs::remove(study);
  fs::create_directory(study);
  driver.app().send(CycleCaseState{"ball"});
  driver.wait_until("a fault is said", [&] { return driver.shows("some.study.json"); });
  driver.app().send(OpenStudy{other});
  driver.wait_until("that is said", [&] { return driver.shows("other.study.json was not opened"); });
  CHECK(driver.state().models.kept.file == study);

  driver.app().ask_to_quit();
  driver.wait_until("it is asked", [&] { return driver.has("Quit without it"); });
  CHECK_FALSE(driver.app().wants_to_quit());
  driver.press(key::escape);
  fs::remove(study);
  driver.app().ask_to_quit();
  driver.wait_until("it closes", [&] { return driver.app().wants_to_quit(); });
  CHECK(test::must(read_whole_file(study)).find("\"in work\"") != std::string::npos);
}

TEST_CASE("a study that could not be saved as another file is said before the window closes") {
  const Ball ball;
  Driver driver(ball.document());
  open_study_of(driver, ball);
  const fs::path taken = driver.folder() / "taken.study.json";
  fs::create_directory(taken);
  driver.app().send(SaveStudyAs{{taken}});
  driver.app().ask_to_quit();
  driver.wait_until("it is asked", [&] { return driver.has("Quit without it"); });
  CHECK(driver.shows("taken.study.json could not be written"));
  driver.click("Quit without it");
  CHECK(driver.app().wants_to_quit());
}

TEST_CASE("a window that is closed during an export waits until the file is whole") {
  Driver driver(demo());
  const auto map = driver.folder() / "organ.nii.gz", mesh = driver.folder() / "organ.ply";
  driver.app().send(ExportLabelMap{{map}});
  driver.app().send(ExportMesh{{mesh}});
  driver.app().ask_to_quit();
  driver.wait_until("it closes", [&] { return driver.app().wants_to_quit(); });
  const Volume written = test::must(read_volume(map)).volume;
  CHECK(labels_of(written).at(1) > 1000);
  CHECK(test::must(read_mesh_file(mesh)).points.rows() == driver.document().view()->shape.points->rows());
}

TEST_CASE("an export that fails keeps the window open") {
  Driver driver(demo());
  driver.app().send(ExportMesh{{driver.folder() / "no folder" / "organ.ply"}});
  driver.app().ask_to_quit();
  driver.wait_until("that is said", [&] { return driver.shows("organ.ply"); });
  driver.settle();
  CHECK_FALSE(driver.app().wants_to_quit());
}

TEST_CASE("work on a study says what it does and is given up only where that is possible") {
  const auto shown = [](const char* subject, const char* verb) { return study_work({subject, 0.5, 1, verb}); };
  CHECK(shown("/far/some.study.json", "Reading study").what == "Reading study some.study.json");
  CHECK(shown("/far/some.study.json", "Reading study").no_cancel == std::string());
  CHECK(shown("/far/some.study.json", "Writing study").what == "Writing study some.study.json");
  CHECK(shown("/far/some.study.json", "Writing study").no_cancel != std::string());
  CHECK(shown("the case of knee", "Making").what == "Making the case of knee");
}

namespace {

VolumeGeometry ball_grid() {
  VolumeGeometry grid;
  grid.dims = {50, 50, 50};
  grid.origin_mm.setConstant(-24.5);
  return grid;
}

fs::path write_labels(const Driver& driver) {
  const fs::path labels = driver.folder() / "labels.nii";
  REQUIRE(write_volume(label_map(icosphere(4, 18), ball_grid(), 3), labels));
  return labels;
}

void make_template_of_labels(Driver& driver) {
  driver.app().send(open_labels(write_labels(driver)));
  driver.settle();
  driver.state().automatic.template_settings.mask.vertices = 500;
  driver.app().send(MakeTemplate{driver.state().automatic.template_settings, {}});
  driver.settle();
}

}  // namespace

TEST_CASE("a template that was made is written like any other file and then used") {
  const Ball ball;
  Driver driver(ball.document());
  make_template_of_labels(driver);
  const fs::path file = driver.folder() / "made.ply";
  driver.app().send(UseMadeTemplate{driver.folder()});
  driver.wait_until("a fault is said", [&] { return driver.shows(driver.folder().string() + ": "); });
  driver.app().send(UseMadeTemplate{file});
  driver.wait_until("it is said that the file is written", [&] { return driver.shows("Written: " + file.string()); });
  driver.wait_until("the case has it",
                    [&] { return driver.document().structure()->the_template->source == file.string(); });
  CHECK(driver.document().view()->shape.points->rows() == 500);
}

TEST_CASE("the window closes only after a template that was made is written") {
  const Ball ball;
  Driver driver(ball.document());
  make_template_of_labels(driver);
  const fs::path file = driver.folder() / "made.ply";
  driver.app().send(UseMadeTemplate{file});
  driver.app().ask_to_quit();
  driver.wait_until("it closes", [&] { return driver.app().wants_to_quit(); });
  CHECK(fs::exists(file));
}

TEST_CASE("a tube that leaves a part of its label out says how much in amber and what to do") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  const Ball ball;
  Driver driver(ball.document(), {1280, 1400, 1});
  driver.state().preferences.sections_open = {{"Case", false}, {"Template", true}, {"Deform", false}};
  driver.app().send(open_labels(write_labels(driver)));
  driver.settle();
  const auto make = [&](const Vec3& base) {
    TemplateSettings& settings = driver.state().automatic.template_settings;
    settings.tube = true;
    settings.tube_options.label = settings.label = 3;
    settings.tube_options.base_and_apex = {base, Vec3(0, 0, -18)};
    driver.app().send(MakeTemplate{settings, {}});
    driver.settle();
    REQUIRE(driver.has("Template/Save and use…"));
  };
  make({0, 0, 18});
  CHECK(!driver.shows("Draw the ruler (D)"));
  make({0, 0, 0});  // the upper half is left out
  REQUIRE(driver.shows("Draw the ruler (D) from the base to the apex"));
  const auto said = std::find_if(driver.items().begin(), driver.items().end(), [](const DrawnItem& item) {
    return item.name.find("Draw the ruler (D)") != std::string::npos;
  });
  REQUIRE(said != driver.items().end());
  CHECK(said->name.find("50 %") != std::string::npos);
  // Amber is drawn there: red and green, with little blue.
  const Picture picture = driver.picture();
  int amber = 0;
  for (int y = static_cast<int>(said->rect.y); y < static_cast<int>(said->rect.y + said->rect.height); ++y)
    for (int x = static_cast<int>(said->rect.x); x < static_cast<int>(said->rect.x + said->rect.width); ++x) {
      const auto pixel =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) + static_cast<std::size_t>(x);
      const std::uint8_t* px = &picture.rgba[4 * pixel];
      amber += px[0] > 150 && px[1] > 100 && px[0] > px[1] + 20 && px[2] < px[1] - 40;
    }
  CHECK(amber > 100);
}

TEST_CASE("a template of a part of a label is made by its neighbours, and fits to the map end there") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  const Ball ball;
  Driver driver(ball.document(), {1280, 1400, 1});
  driver.state().preferences.sections_open = {{"Case", false}, {"Template", true}, {"Deform", false}, {"Place", true}};
  Volume map = label_map(icosphere(4, 18), ball_grid(), 3);
  auto& voxels = std::get<std::vector<std::uint8_t>>(map.data);
  for (int k = 0; k < map.geometry.dims[2]; ++k)
    for (int j = 0; j < map.geometry.dims[1]; ++j)
      for (int i = 0; i < map.geometry.dims[0]; ++i)
        if (auto& voxel = voxels[map.geometry.index(i, j, k)]; voxel == 0 && map.geometry.to_mm(Vec3(i, j, k)).z() > 8)
          voxel = 5;
  const fs::path labels = driver.folder() / "labels.nii", file = driver.folder() / "cup.ply";
  REQUIRE(write_volume(map, labels));
  driver.app().send(open_labels(labels));
  driver.settle();
  driver.state().automatic.template_settings.label = 3;
  driver.settle();
  driver.click("Template/template kind/Part");
  driver.settle();
  CHECK_FALSE(driver.has("Template/faced/Label 3"));
  driver.click("Template/part/Open at");
  driver.settle();
  driver.click("Template/faced/Label 5");
  driver.settle();
  driver.type_into("Template/Vertices/value", "600");
  driver.press(key::enter);
  driver.settle();
  driver.click("Template/Make the template");
  driver.wait_until("the template is made", [&] { return driver.has("Template/Save and use…"); });
  CHECK(driver.shows("open, genus 0"));
  driver.app().send(UseMadeTemplate{file});
  driver.wait_until("the case has it",
                    [&] { return driver.document().structure()->the_template->source == file.string(); });
  const auto the_template = driver.document().structure()->the_template;
  REQUIRE(the_template->faced);
  CHECK(*the_template->faced == FacedNames{"5", false});
  REQUIRE(the_template->topology->rims().size() == 1);
  driver.click("Place/Fit to the label");
  driver.wait_until("the fit is done", [&] { return driver.state().found.last_fit.has_value(); });
  driver.settle();
  CHECK_FALSE(driver.state().found.last_fit->doubtful);
  const Points& fitted = *driver.document().view()->shape.points;
  double height_mm = 0;
  for (const std::int32_t i : the_template->topology->rims().front())
    height_mm += fitted(i, 2) / static_cast<double>(the_template->topology->rims().front().size());
  CHECK(height_mm == doctest::Approx(8).epsilon(0.1));
}

TEST_CASE("an image and its label map are opened together") {
  const Ball ball;
  Driver driver(ball.document());
  const fs::path image = driver.folder() / "ct.nii", labels = write_labels(driver);
  Volume ct;
  ct.geometry = ball_grid();
  ct.data = std::vector<std::int16_t>(ct.geometry.voxels(), 1000);
  REQUIRE(write_volume(ct, image));
  driver.app().send(OpenFiles{{labels, image}});
  driver.wait_until("that is said", [&] { return driver.shows("labels.nii is shown as a label map"); });
  driver.settle();
  CHECK(driver.document().scan.source == image.string());
  CHECK(driver.has("Make the template"));  // whoever opens a scan needs a template: its section is open
}

TEST_CASE("a command that fails ends in a sentence and takes nothing else with it") {
  const Ball ball;
  Driver driver(ball.document());
  driver.app().send(FilterCases{std::string(2000, 'x')});
  driver.app().send(ChooseTool{MouseTool::ruler});
  {
    const test::MemoryEndsAfter none(0);
    InputEvent beside{MouseMove{}};
    beside.over_panel = true;
    driver.app().handle(beside);
  }
  CHECK(driver.state().models.list.filter.empty());
  CHECK(driver.state().hand.tool == MouseTool::ruler);
  driver.frames(2);
  CHECK(driver.shows("This needs more memory than there is"));
}

namespace {

/// What is wrong with the controls that are on the screen: names that are nobody's or several's, places outside of the
/// window.
std::string faults_of(const Driver& driver, const Driver::Size& size) {
  std::string faults;
  std::set<std::string> paths;
  for (const DrawnItem& item : driver.items()) {
    if (!item.is_control()) continue;
    if (item.name.empty()) faults += "a control of " + item.path + " has no name\n";
    if (!paths.insert(item.path).second) faults += item.path + " is there twice\n";
    if (item.rect.width < 1 || item.rect.height < 1) faults += item.path + " has no size\n";
    const bool inside = item.rect.x >= 0 && item.rect.x + item.rect.width <= static_cast<float>(size.width_px);
    if (!inside) faults += item.path + " reaches out of the window\n";
  }
  return faults;
}

}  // namespace

TEST_CASE("every control has a name of its own and lies in the window") {
  const Ball ball;
  const Driver::Size size;
  Driver driver(ball.document(), size);
  add_region(driver, "hilum");
  for (const char* closed : {"Place", "Export"}) driver.click(std::string("side panel/") + closed);
  CHECK(faults_of(driver, size) == "");
  for (const MouseTool tool : {MouseTool::relax, MouseTool::stiffness, MouseTool::confirm}) {
    driver.state().hand.tool = tool;
    driver.frames(2);
    CHECK(faults_of(driver, size) == "");
  }
  driver.press(key::f1);
  CHECK(faults_of(driver, size) == "");
  driver.press(key::escape);
  driver.app().send(ShowFileDialog{FilePurpose::open, {}});
  driver.frames(2);
  CHECK(faults_of(driver, size) == "");
  driver.press(key::escape);
  driver.press(key::tab);
  CHECK(driver.has("Study"));
  CHECK(faults_of(driver, size) == "");
}

}  // namespace homolog
