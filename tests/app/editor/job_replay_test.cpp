#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "app/editor/update/controls.h"
#include "core/base/files/files.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/files/landmark_io.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/phantom/phantom_files.h"
#include "core/volume/volume_io.h"
#include "tests/beating_ball.h"
#include "tests/driver.h"
#include "tests/must.h"

// The jobs that the program is for, each done once by hand on phantoms. The log of its commands is then done again, and
// every file that the job left has to come out as it was, byte for byte.

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// What a job starts from, and where it leaves its files.
struct Desktop {
  TemporaryFolder folder;
  fs::path out = folder.path / "out", log = folder.path / "session.log";
  Document start = new_document({}, nullptr, nullptr);
  Driver::Size window;

  Desktop() { fs::create_directory(out); }
  /// The files that the job left, by name; and an empty folder for the next time.
  std::map<std::string, std::string> take_files() const {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(out))
      if (entry.is_regular_file())
        files[fs::relative(entry.path(), out).string()] = test::must(read_whole_file(entry.path()));
    fs::remove_all(out);
    fs::create_directory(out);
    return files;
  }
};

/// Does a job by hand, then from its log: twice, or once where it takes long.
template <class Job>
void check_job(const Desktop& desktop, std::size_t files, const Job& job, int replays = 2) {
  {
    Driver driver(desktop.start, desktop.window);
    REQUIRE(driver.app().log().write_to(desktop.log));
    job(driver);
    driver.settle();
  }
  const auto by_hand = desktop.take_files();
  CHECK(by_hand.size() == files);
  for (int again = 0; again < replays; ++again) {
    Driver driver(desktop.start, desktop.window);
    driver.app().replay(test::must(read_log(desktop.log)));
    driver.settle();
    std::string notices;
    for (const Notice& notice : driver.state().notices)
      if (notice.error) notices += notice.text + "\n";
    CHECK(notices == "");
    const auto replayed = desktop.take_files();
    CHECK(replayed.size() == by_hand.size());
    for (const auto& [name, bytes] : by_hand) {
      if (name.ends_with(".h5.json")) continue;  // it holds the time at which it was made
      REQUIRE_MESSAGE(replayed.contains(name), name);
      CHECK_MESSAGE(replayed.at(name) == bytes, name, " is another");
    }
  }
}

void pick_file(Driver& driver, const fs::path& file) {
  driver.type_into("name", file.string());
  driver.press(key::enter);
  driver.settle();
}

void open_image(Driver& driver, const fs::path& image, const char* button) {
  driver.app().send(OpenFiles{{image}});  // dropped on the window
  driver.settle();
  if (!driver.has(button)) driver.click("side panel/Template");
  driver.click(button);
  driver.settle();
  REQUIRE(driver.document().view());
}

/// px of a point in a view, which is made to show it.
Eigen::Vector2d show(Driver& driver, ViewKind view, const Vec3& p_mm) {
  driver.app().send(LookAt{p_mm});
  driver.settle();
  return view_map(driver.state(), driver.app().layout(), driver.document(), view).to_px(p_mm).value();
}

void click_at(Driver& driver, ViewKind view, const Vec3& p_mm) {
  const Eigen::Vector2d at = show(driver, view, p_mm);
  driver.move(at.x(), at.y());
  driver.button(MouseButton::left, true);
  driver.button(MouseButton::left, false);
  driver.settle();
}

void drag(Driver& driver, ViewKind view, const Vec3& from_mm, const Vec3& to_mm) {
  const Eigen::Vector2d from = show(driver, view, from_mm);
  const Eigen::Vector2d to =
      view_map(driver.state(), driver.app().layout(), driver.document(), view).to_px(to_mm).value();
  driver.move(from.x(), from.y());
  driver.button(MouseButton::left, true);
  constexpr int steps = 5;
  for (int k = 1; k <= steps; ++k) {
    const Eigen::Vector2d at = from + (to - from) * k / steps;
    driver.move(at.x(), at.y());
  }
  driver.button(MouseButton::left, false);
  driver.settle();
}

/// Pulls the vertex of the outline that is most to one side in the axial slice through the mesh's middle.
void pull_outwards(Driver& driver, double mm) {
  const Points points = *driver.document().view()->shape.points;
  Eigen::Index vertex = 0;
  points.col(0).maxCoeff(&vertex);
  const Vec3 from = points.row(vertex);
  drag(driver, ViewKind::axial, from, from + Vec3(mm, 0, 0));
}

void place_landmarks(Driver& driver, const fs::path& truth, std::size_t count) {
  driver.click("side panel/Place");
  const auto landmarks = test::must(read_landmarks(truth));
  REQUIRE(landmarks.size() >= count);
  for (std::size_t k = 0; k < count; ++k) {
    driver.click(landmarks[k].name + "/row");
    click_at(driver, ViewKind::axial, landmarks[k].position);
    REQUIRE_MESSAGE(driver.document().view()->shape.landmarks.contains(landmarks[k].name), landmarks[k].name);
  }
  driver.click("side panel/Place");
}

/// The image of a phantom, the built-in template of its organ, and the first landmarks clicked where they are.
void start_on_phantom(Driver& driver, const Desktop& desktop, const std::string& phantom, const char* button,
                      std::size_t landmarks) {
  open_image(driver, desktop.folder.path / (phantom + "-image.nii.gz"), button);
  place_landmarks(driver, desktop.folder.path / (phantom + "-landmarks.mrk.json"), landmarks);
}

void snap(Driver& driver) {
  driver.move(5, 5);
  driver.state().found.snapped.reset();
  driver.press('N');
  driver.wait_until("the mesh has snapped", [&] { return driver.state().found.snapped.has_value(); });
  driver.settle();
}

void save_as(Driver& driver, const fs::path& file) {
  driver.press('S', {true, true, false});
  pick_file(driver, file);
  REQUIRE(driver.case_file() == file);
}

void write_files(Driver& driver, const Desktop& desktop) {
  driver.click("side panel/Export");
  driver.click("Export/Mesh…");
  pick_file(driver, desktop.out / "mesh.ply");
  driver.click("Export/Label map…");
  pick_file(driver, desktop.out / "label.nii.gz");
}

}  // namespace

TEST_CASE("a kidney made by hand comes out of its log with the same bytes") {
  Desktop desktop;
  REQUIRE(write_phantom(Organ::kidney, 2, desktop.folder.path));
  check_job(
      desktop, 3,
      [&](Driver& driver) {
        start_on_phantom(driver, desktop, "kidney-2", "Template/Kidney", 4);
        driver.press('P');
        driver.press('1');
        pull_outwards(driver, 2);
        CHECK(driver.document().view()->shape.strokes == 1);
        snap(driver);
        driver.press('Z', {false, true, false});
        driver.settle();
        driver.press('Y', {false, true, false});
        driver.settle();
        save_as(driver, desktop.out / "kidney.homolog");
        write_files(driver, desktop);
      },
      1);
}

TEST_CASE("a vertebra made by hand comes out of its log with the same bytes") {
  Desktop desktop;
  REQUIRE(write_phantom(Organ::vertebra, 2, desktop.folder.path));
  check_job(
      desktop, 1,
      [&](Driver& driver) {
        start_on_phantom(driver, desktop, "vertebra-2", "Template/Vertebra", 5);
        snap(driver);
        driver.click("Correspondence/Refine along the surface");
        driver.settle();
        save_as(driver, desktop.out / "vertebra.homolog");
      },
      1);
}

TEST_CASE("a cine propagated and corrected comes out of its log with the same bytes") {
  Desktop desktop;
  const fs::path image = desktop.folder.path / "cine.nii.gz", ball = desktop.folder.path / "ball.ply";
  REQUIRE(write_volume(BeatingBall::cine(), image));
  const Mesh mesh = icosphere(2, BeatingBall::radius_mm(0));
  REQUIRE(write_mesh_file({mesh.points, mesh.topology->triangles()}, ball));
  check_job(desktop, 1, [&](Driver& driver) {
    driver.app().send(OpenFiles{{image, ball}});
    driver.settle();
    REQUIRE(driver.document().view());
    const auto propagate = [&](std::size_t frames) {
      driver.click("Cine/Propagate");
      driver.wait_until("every frame has a mesh",
                        [&] { return driver.document().structure()->shapes.size() == frames; });
      driver.settle();
    };
    propagate(BeatingBall::frames);
    driver.app().send(ShowFrame{2});
    driver.settle();
    pull_outwards(driver, 2);
    propagate(BeatingBall::frames);
    save_as(driver, desktop.out / "cine.homolog");
  });
}

TEST_CASE("a template of one's own comes out of its log with the same bytes") {
  Desktop desktop;
  VolumeGeometry grid;
  grid.dims = {50, 50, 50};
  grid.origin_mm.setConstant(-24.5);
  const fs::path image = desktop.folder.path / "ct.nii", labels = desktop.folder.path / "labels.nii";
  Volume label = label_map(icosphere(4, 18), grid, 1), ct;
  ct.geometry = grid;
  std::vector<std::int16_t> values(grid.voxels());
  const auto& organ = std::get<std::vector<std::uint8_t>>(label.data);
  std::ranges::transform(organ, values.begin(), [](std::uint8_t one) { return static_cast<std::int16_t>(100 * one); });
  ct.data = std::move(values);
  REQUIRE(write_volume(ct, image));
  REQUIRE(write_volume(label, labels));
  check_job(desktop, 3, [&](Driver& driver) {
    driver.app().send(OpenFiles{{image}});
    driver.settle();
    if (!driver.has("Template/Open a label map…")) driver.click("side panel/Template");
    driver.click("Template/Open a label map…");
    pick_file(driver, labels);
    driver.type_into("Template/Vertices/value", "600");
    driver.press(key::enter);
    driver.click("Template/Make the template");
    driver.wait_until("the template is made", [&] { return driver.has("Template/Save and use…"); });
    driver.settle();
    driver.click("Template/Save and use…");
    pick_file(driver, desktop.out / "ball-template.ply");  // the log writes it again: it is gone by then
    driver.wait_until("the case has it", [&] { return driver.document().view().has_value(); });
    driver.settle();
    // A region is painted and a landmark named, and the template saved with both.
    if (!driver.has("Template/Add")) driver.click("side panel/Template");
    driver.type_into("new region", "pole");
    driver.click("Template/Add");
    driver.settle();
    driver.press('B');
    driver.click("Deform/paints/Region");
    driver.settle();
    click_at(driver, ViewKind::axial, driver.document().view()->shape.points->row(0));
    driver.click("Template/Save the template…");
    pick_file(driver, desktop.out / "mine.ply");
    driver.settle();
    driver.click("side panel/Template");
    if (!driver.has("Place/Fit to the label")) driver.click("side panel/Place");
    driver.click("Place/Fit to the label");
    driver.wait_until("the fit is done", [&] { return driver.state().found.last_fit.has_value(); });
    driver.settle();
    save_as(driver, desktop.out / "ball.homolog");
  });
}

TEST_CASE("a model made of a study comes out of its log with the same bytes") {
  Desktop desktop;
  desktop.window = {1280, 1600, 1};
  for (const double stretch : {1.0, 1.1, 1.25, 1.3}) {
    Mesh ball = icosphere(3, 40);
    ball.points.col(2) *= stretch;
    ball.points.col(0) *= 2 - stretch;
    REQUIRE(
        write_mesh(ball, desktop.folder.path / ("ball" + std::to_string(static_cast<int>(100 * stretch)) + ".ply")));
  }
  check_job(desktop, 8, [&](Driver& driver) {
    driver.press(key::tab);
    driver.settle();
    driver.click("Study");
    driver.click("study menu/New study…");
    pick_file(driver, desktop.out / "balls.study.json");
    for (const char* name : {"ball100.ply", "ball110.ply", "ball125.ply", "ball130.ply"}) {
      driver.click("Meshes…");
      pick_file(driver, desktop.folder.path / name);
    }
    driver.wait_until("the model is made", [&] { return driver.state().models.made.model != nullptr; });
    driver.settle();
    driver.click("cases/ball125/row");
    driver.click("cases/ball125/state");
    driver.settle();
    driver.click("Export model…");
    pick_file(driver, desktop.out / "balls.h5.json");
    driver.click("Measure");
    driver.wait_until("the measures are there", [&] { return driver.state().models.made.evaluation != nullptr; });
    driver.settle();
    driver.click("Table…");
    pick_file(driver, desktop.out / "balls.csv");
    driver.click("models panel/Optimise");
    driver.click("Optimise/Optimise");
    driver.wait_until("the shapes are optimised",
                      [&] { return driver.state().models.made.optimisation.done != nullptr; });
    driver.settle();
    driver.click("Study");
    driver.click("study menu/Export shapes as .ply…");
    pick_file(driver, desktop.out / "optimised");
    driver.click("shapes/As fitted");
    driver.click("models panel/Sizes");
    driver.click("Sizes/Table…");
    pick_file(driver, desktop.out / "sizes.csv");
    driver.click("Optimise/Discard");
  });
}

TEST_CASE("the first ten minutes come out of their log with the same bytes") {
  Desktop desktop;
  check_job(
      desktop, 3,
      [&](Driver& driver) {
        driver.click("Case/First steps…");
        driver.wait_until("the first case is open", [&] { return driver.state().guide.has_value(); });
        driver.settle();
        // Look around.
        const RectPx axial = driver.app().layout().image(ViewKind::axial);
        driver.move(axial.x + axial.width / 2, axial.y + axial.height / 2);
        driver.wheel(2);
        driver.wheel(-2);
        // Pull, as the guide says.
        REQUIRE(driver.state().guide->steps.size() == 5);
        for (std::size_t k = 0; k < 5 && driver.state().guide->at < 5; ++k) {
          const GuideStep step = driver.state().guide->steps[driver.state().guide->at];
          const Vec3 from = pulled_from(step, driver.document().view()->mesh());
          driver.press('3');
          drag(driver, step.view, from, step.to_mm);
          driver.settle();
        }
        CHECK(driver.state().guide->at == 5);
        // Correct features: grab, slide, relax; and take one back.
        driver.press('1');
        for (const int tool : {'G', 'S', 'R'}) {
          driver.press(tool);
          pull_outwards(driver, 1);
        }
        driver.press('Z', {false, true, false});
        driver.settle();
        snap(driver);
        driver.click("Correspondence/Refine along the surface");
        driver.settle();
        save_as(driver, desktop.out / "first.homolog");
        write_files(driver, desktop);
        driver.press(key::tab);
        driver.settle();
        CHECK(driver.has("Study"));
      },
      1);
}

}  // namespace homolog
