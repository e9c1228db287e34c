#include <doctest/doctest.h>

#include <sys/stat.h>

#include <fstream>
#include <set>

#include "app/editor/update/controls.h"
#include "app/editor/update/results/set_fit.h"
#include "core/base/files/files.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/session/case_file.h"
#include "core/volume/labels/write_segmentation.h"
#include "core/volume/volume_io.h"
#include "tests/core/volume/dicom_slices.h"
#include "tests/driver.h"
#include "tests/globe.h"
#include "tests/must.h"
#include "tests/organ_scan.h"

// What a new image, another template and a case that is opened again bring with them.

namespace homolog {

namespace {

namespace fs = std::filesystem;

void open_and_wait(Driver& driver, const fs::path& image) {
  driver.app().send(OpenFiles{{image}});
  driver.wait_until("the image is open", [&] { return driver.document().scan.source == image.string(); });
  driver.settle();
}

void name_landmark(Driver& driver, const std::string& name, const Vec3& at) {
  driver.app().send(ApplyEdit{SetTemplateLandmark{name, at}, false});
  driver.settle();
}

}  // namespace

TEST_CASE("a real heart opens from the first screen with its label map and can be pulled at once") {
  Driver driver(new_document({}, nullptr, nullptr));
  const fs::path image = driver.folder() / "homolog/sample/heart.nii.gz";
  for (int again = 0; again < 2; ++again) {
    driver.click("Case/Sample: a real heart");
    driver.wait_until("the heart is open",
                      [&] { return driver.document().scan.source == image && driver.document().view(); });
    driver.settle();
    CHECK(driver.shows("heart-labels.nii.gz"));
    CHECK(driver.document().structure()->the_template->source == "built-in:ventricle");
    const Vec3 at = driver.document().view()->shape.points->row(0);
    driver.app().send(ApplyEdit{Stroke{Tool::pull, at, at + Vec3(2, 0, 0), 10, {}, false, 1}, false});
    driver.settle();
    CHECK(driver.document().view()->shape.strokes == 1);
    CHECK((fs::status(image.parent_path()).permissions() & fs::perms::others_all) == fs::perms::none);
    write_bytes(image, "damaged");  // it is made anew where it is asked for again
  }
}

TEST_CASE("slices that are no even stack are resampled where asked and a case remembers it") {
  const TemporaryFolder folder;
  const fs::path series = folder.path / "ct", file = folder.path / "a.homolog";
  fs::create_directory(series);
  for (int s = 0; s < 5; ++s) {
    Slice slice;
    slice.y = 1 + 0.75 * s;
    slice.z = 2.5 * s;
    write_bytes(series / (std::to_string(s) + ".dcm"), slice.bytes());
  }
  Driver driver(new_document({}, nullptr, nullptr));
  const auto open = [&] {
    driver.app().send(OpenFiles{{series}});
    driver.wait_until("it is asked", [&] { return std::holds_alternative<ResampleDialog>(*driver.state().dialog); });
    driver.settle();
    CHECK(driver.shows("tilted gantry"));
  };
  open();
  driver.click("Do not open it");
  CHECK_FALSE(driver.state().dialog);
  CHECK_FALSE(driver.document().scan.image);
  open();
  driver.click("Resample and open");
  driver.wait_until("the image is open", [&] { return driver.document().scan.image != nullptr; });
  driver.settle();
  const VolumeGeometry grid = driver.document().scan.image->geometry;
  CHECK(grid.dims[1] > 2);
  CHECK(driver.shows("were resampled to a rectangular grid"));
  driver.app().send(SaveCaseAs{{file}});
  driver.settle();
  CHECK(test::must(read_whole_file(file)).find("\"resampled\":true") != std::string::npos);
  const CaseRead again = test::must(read_case(file));
  CHECK(again.session.document().scan.image->geometry == grid);
}

TEST_CASE("pipes and devices and links in circles are said in the window and neither waited for nor replaced") {
  const Globe globe;
  Driver driver(globe.document());
  const auto at = [&](const char* name) { return globe.folder.path / name; };
  for (const char* pipe : {"pipe.nii", "pipe.homolog", "pipe.study.json"})
    REQUIRE(::mkfifo(at(pipe).c_str(), 0600) == 0);
  for (const char* zero : {"zero.nrrd", "zero.ply", "zero.study.json"}) fs::create_symlink("/dev/zero", at(zero));
  for (const char* loop : {"loop.mha", "loop.homolog"}) fs::create_symlink(loop, at(loop));
  fs::create_symlink("/dev/full", at("full.ply"));
  const auto said = [&](Command command, const std::string& name) {
    driver.state().notices.clear();
    driver.app().send(std::move(command));
    driver.settle();
    std::string all;
    for (const Notice& notice : driver.state().notices) all += notice.text + '\n';
    CHECK_MESSAGE((all.find(name) != std::string::npos || all.find("/dev/") != std::string::npos), name, ": ", all);
  };
  for (const char* name : {"pipe.nii", "pipe.homolog", "zero.nrrd", "zero.ply", "loop.mha", "loop.homolog"})
    said(OpenFiles{{at(name)}}, name);
  for (const char* name : {"pipe.study.json", "zero.study.json"}) said(OpenStudy{{at(name)}}, name);
  for (const char* name : {"full.ply", "pipe.nii"}) said(ExportMesh{{at(name)}}, name);
  said(SaveCaseAs{{at("pipe.homolog")}}, "pipe.homolog");
  CHECK(fs::is_fifo(at("pipe.homolog")));
  CHECK(fs::is_character_file("/dev/full"));
}

TEST_CASE("the window says that it is no medical device") {
  Driver driver(new_document({}, nullptr, nullptr));
  driver.press(key::f1);
  CHECK(driver.shows("It is not a medical device."));
}

TEST_CASE("a scan is opened with grey values that show its tissue and a case with slices through its mesh") {
  const OrganScan scan;
  REQUIRE(write_volume(*OrganScan::image(), scan.folder.path / "scan.nii"));
  Driver driver(scan.document());
  CHECK(driver.state().look.window_low == -160);
  CHECK(driver.state().look.window_high == 240);
  Similarity aside = driver.document().view()->shape.placement;
  aside.translation += Vec3(15, -12, 10);
  driver.app().send(ApplyEdit{SetPlacement{aside}});
  driver.settle();
  const fs::path of_case = driver.case_file();

  // An MR: air of 0 to 4, tissue of 190 to 320, and a few voxels of 8000.
  Volume mr = *OrganScan::image();
  auto& values = std::get<std::vector<std::int16_t>>(mr.data);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = static_cast<std::int16_t>(i % 5000 == 0 ? 8000 : values[i] < -900 ? i % 5 : (values[i] + 1000) / 5);
  REQUIRE(write_volume(mr, driver.folder() / "mr.nii"));
  open_and_wait(driver, driver.folder() / "mr.nii");
  CHECK(driver.state().look.window_low >= 0);
  CHECK(driver.state().look.window_low < 5);
  CHECK(driver.state().look.window_high > 220);
  CHECK(driver.state().look.window_high < 400);

  driver.app().send(OpenFiles{{of_case}});
  driver.wait_until("the case is open again", [&] { return driver.case_file() == of_case; });
  driver.settle();
  const Box box = bounds_of(*driver.document().view()->shape.points);
  CHECK((box.center() - Vec3(15, -12, 10)).norm() < 3);
  CHECK((driver.state().look.crosshair_mm - box.center()).cwiseAbs().maxCoeff() <= 1);  // within half a slice
  CHECK((driver.state().look.camera.target - box.center()).norm() < 0.01);
}

TEST_CASE("the template that was saved is the case's and comes with the next image") {
  const Globe globe;
  Driver driver(globe.document());
  driver.click("side panel/Template");
  driver.type_into("new region", "lip");
  driver.press(key::enter);
  driver.wait_until("the region is there",
                    [&] { return driver.document().structure()->paint.regions->list.size() == 1; });
  driver.app().send(ApplyEdit{PaintRegion{"lip", Vec3(0, 0, 20), 10, 0}, false});
  for (const auto& [name, at] : std::map<std::string, Vec3>{{"north", {0, 0, 20}}, {"east", {20, 0, 0}}})
    name_landmark(driver, name, at);
  driver.click("Template/Save the template…");
  const fs::path mine = driver.folder() / "mine.ply";
  driver.type_into("name", mine.string());
  driver.press(key::enter);
  driver.wait_until("it is said", [&] { return driver.shows("The case goes on with mine.ply"); });
  driver.wait_until("the panel says so", [&] { return driver.shows("mine.ply"); });
  const fs::path file = driver.case_file();

  open_and_wait(driver, globe.image("next.nii"));
  CHECK(driver.document().structure()->the_template->source == mine.string());
  CHECK(driver.document().structure()->the_template->landmarks.size() == 2);
  CHECK(driver.document().structure()->paint.regions->list.size() == 1);

  // The same where the case was opened again in between.
  driver.app().send(OpenFiles{{file}});
  driver.wait_until("the first case is open", [&] { return driver.case_file() == file; });
  driver.settle();
  CHECK(driver.shows("mine.ply"));
  open_and_wait(driver, globe.image("third.nii"));
  CHECK(driver.document().structure()->the_template->source == mine.string());
}

TEST_CASE("a mirrored template is called so and a saved mirror image is not mirrored again") {
  Driver driver(new_document("", nullptr, test::must(load_template("built-in:kidney"))));
  driver.click("side panel/Template");
  CHECK(driver.shows("kidney (built in)"));
  driver.click("Template/Mirror left and right");
  driver.wait_until("the panel says so", [&] { return driver.shows("kidney (built in, mirrored)"); });
  const Points mirrored = driver.document().structure()->the_template->points;
  const fs::path left = driver.folder() / "left.ply";
  driver.app().send(ExportTemplate{left});
  driver.wait_until("it is saved", [&] { return driver.shows("The case goes on with left.ply"); });
  driver.settle();
  CHECK_FALSE(driver.shows("mirrored)"));
  const Globe globe;
  open_and_wait(driver, globe.image("next.nii"));
  CHECK(driver.document().structure()->the_template->points.isApprox(mirrored, 1e-5));
}

TEST_CASE("the template that the open case began with is not written over") {
  const OrganScan scan;
  Driver driver(scan.document());
  const fs::path own = scan.folder.path / "organ.ply";
  const std::string before = test::must(read_whole_file(own));
  driver.app().send(ApplyEdit{SetRegion{Region{"cap", 2, {255, 0, 0}}}});
  driver.settle();
  for (const fs::path& path : {own, scan.folder.path / "." / "organ.ply"}) {
    driver.app().send(ExportTemplate{path});
    driver.settle();
    CHECK(driver.shows("organ.ply is the template that this case began with, and has to stay as it is."));
    CHECK(test::must(read_whole_file(own)) == before);
    driver.app().send(DismissNotice{0});
    driver.settle();
  }
  driver.app().send(ExportTemplate{scan.folder.path / "mine.ply"});
  driver.wait_until("it is saved", [&] { return driver.shows("The case goes on with mine.ply"); });
}

TEST_CASE("the button that mirrors leaves a template of another scan where it lies") {
  MeshFile file = to_mesh_file(*test::must(load_template("built-in:kidney")));
  file.points.rowwise() += Eigen::RowVector3d(-180, 60, 900);
  file.landmarks.clear();
  Similarity placement;
  placement.translation = Vec3(170, -50, -880);
  Driver driver(new_document("", nullptr, test::must(make_template(std::move(file), "own.ply")), placement));
  const Eigen::RowVector3d before = driver.document().view()->shape.points->colwise().mean();
  driver.click("side panel/Template");
  driver.click("Template/Mirror left and right");
  driver.wait_until("it is mirrored", [&] { return driver.document().structure()->the_template->points(0, 0) > 0; });
  driver.settle();
  const Points& after = *driver.document().view()->shape.points;
  CHECK((after.colwise().mean() - before).norm() < 1e-6);
  CHECK(driver.lines_with("\"keeps\"") == 1);
}

TEST_CASE("a template that was made of a label on the image stays there and the cine at its frame") {
  const Globe globe;
  Driver driver(globe.on(globe.image("cine.nii", 5)));
  driver.app().send(ShowFrame{3});
  driver.settle();
  // The label's ball lies aside of the image's centre.
  Mesh ball = icosphere(4, 12);
  ball.points.rowwise() += Eigen::RowVector3d(8, -6, 5);
  const fs::path labels = driver.folder() / "labels.nii";
  REQUIRE(write_volume(label_map(ball, Globe::grid(), 1), labels));
  driver.app().send(open_labels(labels));
  driver.settle();
  driver.state().automatic.template_settings.mask.vertices = 500;
  driver.app().send(MakeTemplate{driver.state().automatic.template_settings, {}});
  driver.settle();
  const Vec3 looked_at = driver.state().look.crosshair_mm;
  const double zoom = driver.state().look.slices[0].mm_per_px;
  const fs::path made = driver.folder() / "made.ply";
  driver.app().send(UseMadeTemplate{made});
  driver.wait_until("the case has it",
                    [&] { return driver.document().structure()->the_template->source == made.string(); });
  driver.settle();
  CHECK(driver.document().frame == 3);
  CHECK(driver.app().snapshot().shown->frame == 3);
  CHECK((bounds_of(*driver.document().view()->shape.points).center() - Vec3(8, -6, 5)).norm() < 0.5);
  CHECK(driver.state().look.crosshair_mm == looked_at);
  CHECK(driver.state().look.slices[0].mm_per_px == zoom);
}

TEST_CASE("of a label map whose segments overlap each layer can be shown and worked with") {
  const Globe globe;
  Driver driver(globe.on(globe.image("ct.nii")));
  const auto ball_at = [](double x_mm, double radius_mm) {
    Mesh ball = icosphere(4, radius_mm);
    ball.points.col(0).array() += x_mm;
    return ball;
  };
  VolumeRead map{.volume = label_map(ball_at(4, 14), Globe::grid(), 1),
                 .other_layers = {label_map(ball_at(-6, 10), Globe::grid(), 1)}};
  map.segmentation.add({.name = "lung", .value = 1, .layer = 0});
  map.segmentation.add({.name = "tumour", .value = 1, .layer = 1});
  const fs::path file = driver.folder() / "two.seg.nrrd";
  REQUIRE(write_segmentation(map, file));
  driver.app().send(open_labels(file));
  driver.settle();
  driver.app().send(OpenSection{"Case"});
  driver.settle();
  const auto made = [&](const char* name) {
    driver.state().automatic.template_settings.mask.vertices = 500;
    driver.app().send(MakeTemplate{driver.state().automatic.template_settings, {}});
    driver.settle();
    const fs::path into = driver.folder() / name;
    driver.app().send(UseMadeTemplate{into});
    driver.wait_until("the case has it",
                      [&] { return driver.document().structure()->the_template->source == into.string(); });
    driver.settle();
    return Vec3(bounds_of(*driver.document().view()->shape.points).center());
  };
  TemplateSet set;
  set.structures = {{.name = "tumour"}, {.name = "liver"}};
  ShownLabels shown;
  shown.layers = {{.volume = nullptr, .values = {1}, .sizes_mm = {}, .names = {{1, "lung"}}, .colours = nullptr},
                  {.volume = nullptr, .values = {1}, .sizes_mm = {}, .names = {{1, "tumour"}}, .colours = nullptr}};
  CHECK(names_in_map(set, shown) == std::vector<std::string>{"tumour"});
  CHECK((made("first.ply") - Vec3(4, 0, 0)).norm() < 0.5);
  driver.app().send(ShowLabelsLayer{1});
  driver.settle();
  CHECK((made("second.ply") - Vec3(-6, 0, 0)).norm() < 0.5);
  driver.app().send(ShowLabelsLayer{2});  // there is none
  driver.settle();
}

TEST_CASE("a case is shown with the window that it was left with") {
  const Globe globe;
  const fs::path image = globe.image("ct.nii");
  Driver driver(globe.on(image));
  const fs::path file = driver.case_file();
  CHECK(driver.lines_with("window") == 0);
  driver.app().send(SetWindow{-20, 60});
  driver.settle();
  CHECK(driver.lines_with("\"window\":[-20.0,60.0]") == 1);
  CHECK_FALSE(driver.app().snapshot().can_undo);
  open_and_wait(driver, globe.image("other.nii"));
  CHECK(driver.state().look.window_low != -20);
  driver.app().send(OpenFiles{{file}});
  driver.wait_until("the case is open again", [&] { return driver.case_file() == file; });
  CHECK(driver.state().look.window_low == -20);
  CHECK(driver.state().look.window_high == 60);
}

TEST_CASE("the status line says that a template has no landmarks instead of that all are placed") {
  const Globe globe;
  Driver driver(globe.document());
  driver.press('L');
  CHECK(driver.shows("This template has no landmarks yet"));
  CHECK_FALSE(driver.shows("landmarks are placed; drag"));
  name_landmark(driver, "north", Vec3(0, 0, 20));
  driver.press('P');
  driver.press('L');
  CHECK(driver.shows("Click where \"north\" is."));
}

TEST_CASE("each landmark is listed once and choosing a placed one leaves the slices where they are") {
  const Globe globe;
  Document document = globe.on(globe.image("ct.nii"));
  document.change({}, [&](Structure& first) { first.landmarks.hold = true; });
  Driver driver(document);
  for (const auto& [name, at] : std::map<std::string, Vec3>{{"north", {0, 0, 20}}, {"south", {0, 0, -20}}})
    name_landmark(driver, name, at);
  driver.click("side panel/Place");
  const auto rows = [&](const char* name) {
    return std::count_if(driver.items().begin(), driver.items().end(),
                         [&](const DrawnItem& item) { return item.name == name && !item.is_control(); });
  };
  CHECK(std::any_of(driver.items().begin(), driver.items().end(),
                    [](const DrawnItem& item) { return item.name.find("next") != std::string::npos; }));
  driver.click("side panel/Template");
  CHECK(rows("south") == 1);
  driver.app().send(ApplyEdit{PlaceLandmark{"north", Vec3(0, 0, 20)}, false});
  driver.settle();
  const Vec3 before = driver.state().look.crosshair_mm;
  driver.click("north/row");
  CHECK(driver.state().look.crosshair_mm == before);
  CHECK(driver.state().hand.tool == MouseTool::landmark);
  CHECK(driver.shows("Click where \"north\" is now"));
  driver.click("north/go there");
  CHECK(driver.state().look.crosshair_mm.z() == doctest::Approx(20));

  driver.click("north/release");
  driver.wait_until("it is free", [&] { return driver.has("north/hold"); });
  CHECK(driver.lines_with("\"held\":false") == 1);
  driver.click("north/hold");
  driver.wait_until("it is held", [&] { return driver.has("north/release"); });
}

TEST_CASE("a label map that does not meet the image says so and one that does is quiet") {
  const Globe globe;
  Driver driver(globe.on(globe.image("ct.nii")));
  const fs::path inside = globe.folder.path / "inside.nii", outside = globe.folder.path / "outside.nii";
  write_ball_map(inside, 10, {0, 0, 0});
  Volume moved = test::must(read_volume(inside)).volume;
  moved.geometry.origin_mm += Vec3(0, 0, 200);
  REQUIRE(write_volume(moved, outside));
  driver.app().send(open_labels(inside));
  driver.settle();
  CHECK(driver.state().notices.empty());
  driver.app().send(open_labels(outside));
  driver.settle();
  REQUIRE(driver.state().notices.size() == 1);
  CHECK(driver.state().notices.front().text.starts_with("outside.nii lies outside the image"));
  CHECK(driver.state().notices.front().text.find("one scan") != std::string::npos);

  // A case of a study is opened with its label map.
  OpenRequested both = open_case_file(globe.folder.path / "kept.homolog");
  REQUIRE(create_case(globe.on(globe.image("ct.nii")), both.request.case_file));
  both.request.labels = outside;
  driver.state().notices.clear();
  driver.app().send(both);
  driver.settle();
  CHECK(driver.case_file() == both.request.case_file);
  REQUIRE(driver.state().notices.size() == 1);
  CHECK(driver.state().notices.front().text.starts_with("outside.nii lies outside the image"));
}

}  // namespace homolog
