#include <doctest/doctest.h>

#include <imgui.h>

#include <algorithm>
#include <map>
#include <set>

#include "app/editor/state/view_geometry.h"
#include "app/editor/update/controls.h"
#include "app/editor/widgets/imgui_context.h"
#include "app/editor/widgets/plots.h"
#include "app/editor/widgets/widgets.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/volume/volume_io.h"
#include "tests/driver.h"
#include "tests/must.h"
#include "tests/organ_scan.h"
#include "tests/screens.h"

// What the window says: whole, where it is meant, and in the colour that it deserves.

namespace homolog {

namespace {

namespace fs = std::filesystem;

bool covers(const RectPx& a, const RectPx& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

/// The texts of a part of the window.
std::vector<DrawnItem> texts_in(const Driver& driver, const std::string& part) {
  std::vector<DrawnItem> texts;
  for (const DrawnItem& item : driver.items())
    if (item.kind == DrawnItem::Kind::text && item.path.starts_with(part + "/")) texts.push_back(item);
  return texts;
}

const DrawnItem* text_of(const std::vector<DrawnItem>& texts, const std::string& words) {
  const auto found = std::find_if(texts.begin(), texts.end(),
                                  [&](const DrawnItem& text) { return text.name.find(words) != std::string::npos; });
  return found == texts.end() ? nullptr : &*found;
}

/// Which texts of a view cover each other or leave it.
std::string faults_in_view(const Driver& driver, const std::string& part, const RectPx& view) {
  const auto texts = texts_in(driver, part);
  std::string faults;
  for (std::size_t a = 0; a < texts.size(); ++a) {
    const RectPx& rect = texts[a].rect;
    if (rect.x < view.x || rect.x + rect.width > view.x + view.width || rect.y < view.y ||
        rect.y + rect.height > view.y + view.height)
      faults += texts[a].name + " leaves the view\n";
    for (std::size_t b = a + 1; b < texts.size(); ++b)
      if (covers(rect, texts[b].rect)) faults += texts[a].name + " meets " + texts[b].name + "\n";
  }
  return faults;
}

}  // namespace

TEST_CASE("why a case is in doubt is said in as many lines as it needs") {
  const OrganScan scan;
  Driver driver(scan.document(), {1024, 700, 1});
  REQUIRE(write_mesh(icosphere(2, 20), scan.folder.path / "anna.ply"));
  driver.state().models.shown = true;
  driver.app().send(AddCases{{scan.folder.path / "anna.ply"}});
  driver.settle();
  const std::string doubt =
      "The fit leaves 3.2 ml of the label out, 14 mm from the mesh, and the mesh is stretched by 40 % there.";
  driver.state().models.study.cases.front().doubt = doubt;
  ++driver.state().models.kept.shapes_revision;
  driver.app().send(SelectCase{"anna"});
  driver.settle();
  const auto texts = texts_in(driver, "cases");
  const DrawnItem* said = text_of(texts, doubt);
  REQUIRE(said != nullptr);
  CHECK(said->rect.height > 30);
  CHECK(said->seen.height == said->rect.height);
  for (const char* name : {"selected case/group", "selected case/notes"})
    CHECK(driver.control(name).seen.height == driver.control(name).rect.height);
}

TEST_CASE("names and the scale bar leave no view and cover neither each other nor the letters of the sides") {
  const OrganScan scan;
  Driver driver(scan.document({"upper end", "lower end", "left side of the hilum"}), {800, 600, 1});
  for (const auto& [name, at] : std::map<std::string, Vec3>{
           {"upper end", {20, 1, 0}}, {"lower end", {-20, 1, 0}}, {"left side of the hilum", {0, -20, 0}}})
    driver.app().send(ApplyEdit{PlaceLandmark{name, at}});
  driver.settle();
  driver.state().look.crosshair_mm = Vec3::Zero();
  const RectPx view = driver.app().layout().image(ViewKind::axial);
  SlicePan& pan = driver.state().look.slices[index_of(ViewKind::axial)];
  pan.centre_mm = Vec3::Zero();
  // At each zoom the bar has another length; at some the landmarks lie at the view's edges.
  for (const double mm_across : {40.5, 42.0, 44.0, 47.0, 52.0, 60.0, 75.0, 95.0, 120.0}) {
    CAPTURE(mm_across);
    pan.mm_per_px = mm_across / static_cast<double>(view.width);
    driver.frames(2);
    CHECK(faults_in_view(driver, "axial view", view) == "");
    CHECK(text_of(texts_in(driver, "axial view"), " mm") != nullptr);
  }
}

TEST_CASE("the distance of a landmark is said in grey since nothing is wrong with it") {
  const auto gl = test::context_or_skip();
  if (!gl) return;
  const OrganScan scan;
  Driver driver(scan.document(), {1024, 900, 1});
  driver.state().preferences.sections_open = {{"Case", false}, {"Template", false}, {"Place", true}};
  driver.app().send(ApplyEdit{SetLandmarkPull{LandmarkPull::off}});
  driver.app().send(ApplyEdit{PlaceLandmark{"upper end", Vec3(0, 0, 27)}});
  driver.settle();
  const auto texts = texts_in(driver, "side panel");
  const DrawnItem* off = text_of(texts, "mm off");
  REQUIRE(off != nullptr);
  const Picture picture = driver.picture();
  int amber = 0, grey = 0;
  for (int y = static_cast<int>(off->rect.y); y < static_cast<int>(off->rect.y + off->rect.height); ++y)
    for (int x = static_cast<int>(off->rect.x); x < static_cast<int>(off->rect.x + off->rect.width); ++x) {
      const std::uint8_t* px = &picture.rgba[4 * static_cast<std::size_t>(y * picture.width + x)];
      const int warm = px[0] - px[2];
      amber += px[0] > 150 && warm > 80;
      grey += px[0] > 100 && std::abs(warm) < 40;
    }
  CHECK(amber == 0);
  CHECK(grey > 20);
}

TEST_CASE("hints lie in the views until their time is over or they are followed by keys") {
  const OrganScan scan;
  Driver driver(scan.document());
  driver.state().preferences.hints = {};
  driver.frames(2);
  CHECK(driver.shows("Drag the coloured outline"));
  CHECK(driver.shows("Turn the wheel to go through the slices"));
  driver.press('L');  // a click of that tool does something else
  CHECK_FALSE(driver.shows("Drag the coloured outline"));
  driver.press('P');
  driver.press(key::up);
  CHECK_FALSE(driver.shows("Turn the wheel to go through the slices"));
  CHECK(driver.shows("Drag the coloured outline"));
  driver.app().update(1000);
  driver.frames(2);
  CHECK_FALSE(driver.shows("Drag the coloured outline"));
}

TEST_CASE("J looks at the next fault with the patient upright and says which it is") {
  const OrganScan scan;
  Driver driver(scan.document());
  SetPoints broken;
  auto points = std::make_shared<Points>(*driver.document().view()->shape.points);
  points->row(5) *= -1.3;
  broken.points = points;
  driver.app().send(ApplyEdit{broken});
  driver.settle();
  driver.wait_until("the fault is measured", [&] { return driver.has("Correspondence/Intersecting pairs"); });
  driver.state().look.camera.to_eye = Vec3(0, -1, 0);
  driver.state().look.camera.up = Vec3(1, 0, 0);  // rolled
  driver.press('J');
  driver.settle();
  REQUIRE(driver.state().found.finding);
  const Vec3 up = driver.state().look.camera.up, to_eye = driver.state().look.camera.to_eye;
  REQUIRE(std::abs(to_eye.z()) < 0.95);  // not straight from above, where there is no upright
  CHECK(up.z() > 0);
  CHECK(std::abs(up.dot(Vec3::UnitZ().cross(to_eye))) < 1e-6);  // not tilted to one side
  const auto texts = texts_in(driver, "3D view");
  CHECK(text_of(texts, finding_words(driver.state().found.finding->finding.kind)) != nullptr);
}

TEST_CASE("a share is said with where it lies and never beyond all of it") {
  const ImGuiAlone imgui;
  const Theme theme = make_theme(1);
  ImGui::GetIO().DisplaySize = {800, 600};
  DrawnItems drawn;
  ImGui::NewFrame();
  begin_controls();
  ImGui::Begin("plot");
  const Plot plot{"Compactness", "%", "share of the variance, %", {{0.965, 0.483}}, 100, 1, 100, {}};
  draw_plot(*ImGui::GetWindowDrawList(), theme, {20, 20, 400, 150}, plot, ImVec2{220, 100});
  ImGui::End();
  ImGui::EndFrame();
  const bool said = std::any_of(drawn.items().begin(), drawn.items().end(), [](const DrawnItem& item) {
    return item.name.find("1 mode: 96.5 % (48 to 100)") != std::string::npos;
  });
  CHECK(said);
}

TEST_CASE("the foot line names the overlay's label at the pointer") {
  const OrganScan scan;
  REQUIRE(write_volume(label_map(icosphere(4, 18), OrganScan::grid(), 7), scan.folder.path / "label.nii"));
  Driver driver(scan.document());
  driver.app().send(open_labels(scan.folder.path / "label.nii"));
  driver.settle();
  const auto point_at = [&](const Vec3& p_mm) {
    const auto at = view_map(driver.state(), driver.app().layout(), driver.document(), ViewKind::axial).to_px(p_mm);
    REQUIRE(at);
    driver.move(at->x(), at->y());
    driver.frames(2);
    const auto texts = texts_in(driver, "status line");
    return text_of(texts, "label 7") != nullptr;
  };
  driver.state().look.crosshair_mm = Vec3::Zero();
  CHECK(point_at({5, 5, 0}));
  CHECK_FALSE(point_at({30, 5, 0}));
}

}  // namespace homolog
