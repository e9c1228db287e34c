#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <set>
#include <sstream>
#include <thread>

#include "app/editor/update/file_purposes.h"
#include "app/editor/work/files/file_browsing.h"
#include "core/base/files/files.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/model/files/statismo.h"
#include "core/volume/volume_io.h"
#include "tests/driver.h"
#include "tests/must.h"

// Every control that the program draws is operated, and does something. The list of controls is what the program itself
// says that it draws, so that a new one is operated too.

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// A ball on an image of it, with regions and landmarks, and its label map in a file.
struct BallScene {
  TemporaryFolder folder;
  fs::path label = folder.path / "label.nii.gz";
  Document document;

  BallScene() {
    const Mesh mesh = icosphere(3, 40);
    MeshFile ball{mesh.points, mesh.topology->triangles()};
    ball.landmarks = {{"north", Vec3(0, 0, 40)}, {"south", Vec3(0, 0, -40)}, {"west", Vec3(40, 0, 0)}};
    const fs::path file = folder.path / "ball.ply";
    REQUIRE(write_mesh_file(ball, file));
    REQUIRE(write_whole_file(folder.path / "ball.recipe.json", R"({"homolog_recipe": 1, "measurements": [
      {"name": "across", "kind": "distance", "from": {"kind": "landmark", "landmark": "north"},
       "to": {"kind": "landmark", "landmark": "south"}}]})"));
    ShapeMatrix balls(3 * mesh.points.rows(), 4);
    for (Eigen::Index k = 0; k < balls.cols(); ++k) {
      const Points drawn =
          mesh.points * Vec3(1 + 0.1 * static_cast<double>(k), 1 + 0.1 * static_cast<double>(k % 2), 1).asDiagonal();
      balls.col(k) = Eigen::Map<const Eigen::VectorXd>(drawn.data(), drawn.size());
    }
    REQUIRE(write_model(make_model(principal_components(std::move(balls)), 1, mesh.topology, {}),
                        folder.path / "ball.h5.json"));
    VolumeGeometry grid;
    grid.dims = {60, 60, 60};
    grid.spacing_mm.setConstant(1.6);
    grid.origin_mm.setConstant(-47);
    const Volume labels = label_map(icosphere(4, 37), grid, 1);
    REQUIRE(write_volume(labels, label));
    document = new_document("", std::make_shared<const Volume>(labels), test::must(load_template(file.string())));
  }
};

/// What is in hand or selected already when the test comes to it: choosing it again changes nothing.
bool is_chosen_already(const std::string& path) {
  constexpr std::array paths{"side panel/Template/a name/a name", "side panel/Template/Click…", "cases/next",
                             "cases/kidney-03/row"};
  return std::ranges::find(paths, path) != paths.end();
}

class Operator {
 public:
  explicit Operator(Driver& driver) : driver_(driver) {}

  /// Operates all controls of a part of the window that is shown anew for each of them: a dialog or a menu.
  void operate_each(const std::string& part, const std::function<void()>& show) {
    for (int k = 0; k < 100; ++k) {
      tidy();
      show();
      driver_.settle();
      const auto next = wanted(part);
      if (!next) return;
      done_.insert(next->pattern);
      const std::string before = fingerprint();
      use(*next);
      if (fingerprint() == before) dead_ += "\n  " + next->path;
    }
    FAIL("the controls of " << part << " come to no end");
  }
  /// Operates all controls of a part of the window, also those that appear meanwhile.
  void operate(const std::string& part) {
    for (int k = 0; k < 300; ++k) {
      const auto next = wanted(part);
      if (!next) return;
      done_.insert(next->pattern);
      put_off();
      driver_.settle();
      const std::string before = fingerprint();
      use(*next);
      // Some work goes on beside the window, and nobody waits for it.
      for (int wait = 0; wait < 200 && fingerprint() == before; ++wait) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        driver_.frame();
      }
      if (fingerprint() == before && !is_chosen_already(next->path)) dead_ += "\n  " + next->path;
      tidy();
    }
    FAIL("the controls of " << part << " come to no end");
  }
  const std::string& dead() const { return dead_; }
  std::size_t operated() const { return done_.size(); }

 private:
  std::optional<DrawnItem> wanted(const std::string& part) const {
    for (const DrawnItem& item : driver_.items()) {
      if (!item.is_control() || !item.enabled || !item.path.starts_with(part) || done_.contains(item.pattern)) continue;
      const bool chosen = item.kind == DrawnItem::Kind::choice && item.value == "on";
      const bool closes = item.kind == DrawnItem::Kind::section && item.value == "on";
      if (!chosen && !closes) return item;
    }
    return std::nullopt;
  }

  void use(const DrawnItem& item) {
    switch (item.kind) {
      case DrawnItem::Kind::track:
        driver_.hold_and_move(item.path, item.rect.width / 7, 0);
        driver_.let_go();
        break;
      case DrawnItem::Kind::area:
        driver_.hold_and_move(item.path, 40, 10);
        driver_.let_go();
        break;
      case DrawnItem::Kind::number:
        driver_.type_into(item.path, "7");
        driver_.press(key::enter);
        break;
      case DrawnItem::Kind::field:
        driver_.type_into(item.path, "a name");
        driver_.press(key::enter);
        break;
      default:
        driver_.click(item.path);
    }
    driver_.settle();
  }

  /// What a person could see of a change. That something is written into the log is no change.
  std::string fingerprint() const {
    const EditorState& state = driver_.state();
    const Look& look = state.look;
    std::ostringstream views;
    for (const Camera3D& camera : {look.camera, state.models.gallery.camera})
      views << camera.to_eye.transpose() << ' ' << camera.up.transpose() << ' ' << camera.target.transpose() << ' '
            << camera.distance_mm << ' ';
    views << look.crosshair_mm.transpose() << ' ' << look.window_low << ' ' << look.window_high << ' '
          << static_cast<int>(state.hand.tool) << ' ' << static_cast<int>(state.preferences.show.plane_look) << ' '
          << state.hand.template_landmark << ' ' << state.models.list.selected;
    for (const double deviation : state.models.view.deviations) views << ' ' << deviation;
    for (const SlicePan& slice : look.slices) views << ' ' << slice.centre_mm.transpose() << ' ' << slice.mm_per_px;
    std::string all = views.str() + ' ' + std::to_string(driver_.app().snapshot().committed) + ' ' +
                      std::to_string(driver_.state().notices.size()) + ' ' +
                      std::to_string(driver_.app().wants_to_quit());
    for (const DrawnItem& item : driver_.items())
      if (item.kind != DrawnItem::Kind::tip) all += '\n' + item.path + '=' + item.value;
    return all;
  }

  /// Off what buttons such as "fit", "Auto" and "Mean" bring about, so that they have something to do.
  void put_off() {
    EditorState& state = driver_.state();
    for (Camera3D* camera : {&state.look.camera, &state.models.gallery.camera}) camera->distance_mm *= 1.01;
    state.look.window_high *= 1.01;
    if (!state.models.view.deviations.empty()) state.models.view.deviations.front() += 0.01;
  }

  void tidy() {
    for (int k = 0; k < 5 && (driver_.state().dialog || driver_.has("menu")); ++k) driver_.press(key::escape);
    while (!driver_.state().notices.empty()) driver_.app().send(DismissNotice{0}), driver_.settle();
    driver_.settle();
  }

  Driver& driver_;
  std::set<std::string> done_;
  std::string dead_;
};

/// A dialog as it is shown, and what its window is called.
struct ShownDialog {
  std::string title;
  Dialog dialog;
};

/// Each kind at least once.
std::vector<ShownDialog> all_dialogs(const fs::path& folder) {
  const FileDialog opens{FilePurpose::open, browse(file_purpose(FilePurpose::open).files, folder)};
  const FileDialog adds{FilePurpose::add_shapes, browse(file_purpose(FilePurpose::add_shapes).files, folder)};
  const FileDialog saves{FilePurpose::export_mesh,
                         browse(file_purpose(FilePurpose::export_mesh).files, folder, "a.ply")};
  const auto title = [](const FileDialog& files) { return std::string(file_purpose(files.purpose).title); };
  SeriesInfo series;
  series.uid = "1.2.3";
  series.files = 4;
  RecoverDialog recover;
  recover.found = {{folder / "gone.homolog", "ct.nii", "12 edits"}};
  RecoverDialog asked = recover;
  asked.to_discard = recover.found.front().journal;
  return {{"Keys and mouse", KeysDialog{}},
          {title(opens), opens},
          {title(adds), adds},
          {title(saves), saves},
          {"Replace the file?", ReplaceDialog{saves, folder / "a.ply"}},
          {"This folder contains several series", SeriesDialog{{}, {series}}},
          {"Are the mesh's coordinates RAS?", FlipDialog{"ball", {}, Box(Vec3::Zero(), Vec3::Ones())}},
          {"Cases that were not saved", recover},
          {"Cases that were not saved", asked},
          {"This case was not saved", QuitDialog{}},
          {"The study was not saved", QuitDialog{folder / "a.study.json"}},
          {"How large is a voxel?", SpacingDialog{}},
          {"The slices are no even stack", ResampleDialog{{}, "unevenly spaced slices"}},
          {"Which label is the organ?", LabelDialog{"labels.nii", {{"liver", 1}, {"", 4}}}}};
}

}  // namespace

TEST_CASE("every control of every dialog does something") {
  const BallScene scene;
  const fs::path files = scene.folder.path / "files";
  fs::create_directory(files);
  fs::create_directory(files / "inner");
  REQUIRE(write_mesh(icosphere(1), files / "a.ply"));
  std::set<std::size_t> kinds;
  std::size_t operated = 0;
  for (const ShownDialog& one : all_dialogs(files)) {
    kinds.insert(one.dialog.index());
    Driver driver(scene.document);
    Operator hands(driver);
    hands.operate_each(one.title, [&] {
      driver.state().quitting = Quitting::no;
      driver.state().dialog = one.dialog;
    });
    CHECK_MESSAGE(hands.operated() > 0, one.title);
    CHECK_MESSAGE(hands.dead().empty(), "These do nothing:", hands.dead());
    operated += hands.operated();
  }
  CHECK(kinds.size() == std::variant_size_v<Dialog>);
  CHECK(operated > 40);
}

TEST_CASE("every item of every menu and every button of a card does something") {
  const BallScene scene;
  Driver driver(scene.document);
  driver.app().send(ApplyEdit{SetStiffnessBase{7}});
  driver.app().send(ApplyEdit{Confirm{Vec3(0, 0, 40), 8, true}});
  driver.settle();
  Operator hands(driver);
  hands.operate_each("top bar/history/", [&] { driver.click("top bar/history"); });
  driver.app().send(OpenPhantomStudy{});
  driver.wait_until("the model is made", [&] { return driver.state().models.made.model != nullptr; });
  hands.operate_each("cases/study menu/", [&] {
    driver.app().send(ShowModels{true});
    driver.settle();
    driver.click("Study");
  });
  driver.app().send(ShowModels{false});
  driver.settle();
  hands.operate_each("guide/", [&] {
    driver.state().guide = guide_to(driver.document().view()->mesh(), 1.2 * *driver.document().view()->shape.points);
    driver.state().guide->at = 2;
  });
  driver.state().guide.reset();
  hands.operate_each("notice 0/", [&] {
    Notice notice{"a.homolog could not be read."};
    notice.kept = scene.folder.path / "before.homolog";
    driver.state().notices = {notice};
  });
  CHECK(hands.operated() > 12);
  CHECK_MESSAGE(hands.dead().empty(), "These do nothing:", hands.dead());
}

TEST_CASE("every control of the case does something") {
  const BallScene scene;
  Driver driver(scene.document, {1280, 2400, 1});
  driver.app().send(open_labels(scene.label));
  driver.settle();
  driver.app().send(ChooseRecipe{(scene.folder.path / "ball.recipe.json").string()});
  driver.app().send(OpenScoreModel{{scene.folder.path / "ball.h5.json"}});
  for (const char* section : {"Template", "Place", "Measurements", "Score", "Export"}) {
    driver.app().send(OpenSection{section, true});
    driver.settle();
  }
  driver.app().send(ApplyEdit{SetRegion{{"cap", 2, {255, 0, 0}}}});
  driver.settle();
  driver.app().send(ChooseTool{MouseTool::grab});  // so that the first tool is another
  driver.settle();
  Operator hands(driver);
  for (const char* part :
       {"tool strip", "side panel/Correspondence", "side panel/Deform", "side panel/Place", "side panel/Template",
        "side panel/Measurements", "side panel/Score", "side panel/Export", "side panel/Case", "axial", "top bar"})
    hands.operate(part);
  CHECK(hands.operated() > 120);
  CHECK_MESSAGE(hands.dead().empty(), "These do nothing:", hands.dead());
}

TEST_CASE("every control of the models does something") {
  const BallScene scene;
  Driver driver(scene.document, {1280, 1600, 1});
  driver.app().send(OpenPhantomStudy{});
  driver.wait_until("the model is made", [&] { return driver.state().models.made.model != nullptr; });
  driver.settle();
  Operator hands(driver);
  for (const char* part : {"gallery", "model", "side panel", "cases"}) hands.operate(part);
  CHECK(hands.operated() > 50);
  CHECK_MESSAGE(hands.dead().empty(), "These do nothing:", hands.dead());
}

}  // namespace homolog
