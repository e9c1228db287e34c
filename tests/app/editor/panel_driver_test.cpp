#include <doctest/doctest.h>

#include <algorithm>
#include <cctype>
#include <map>

#include "app/editor/scene/mesh_colouring.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/volume/volume_io.h"
#include "tests/ball.h"
#include "tests/beating_ball.h"
#include "tests/changed_shape.h"
#include "tests/driver.h"
#include "tests/must.h"
#include "tests/organ_scan.h"

// What lies in the side panel stays where a person saw it, and what is opened is seen.

namespace homolog {

namespace {

/// Where the panel's controls and texts are, by their paths.
std::map<std::string, float> places(const Driver& driver) {
  std::map<std::string, float> all;
  for (const DrawnItem& item : driver.items())
    if (item.is_control() && item.path.starts_with("side panel")) all[item.path] = item.rect.y;
  return all;
}

}  // namespace

TEST_CASE("nothing in the panel moves when a label map is opened or closed or fitted to") {
  const TemporaryFolder folder;
  VolumeGeometry grid;
  grid.dims = {50, 50, 50};
  grid.spacing_mm.setConstant(1.6);
  grid.origin_mm.setConstant(-40);
  Volume labels = label_map(icosphere(3, 24), grid, 1);
  std::get<std::vector<std::uint8_t>>(labels.data)[0] = 2;  // two labels to choose from
  const auto file = folder.path / "label.nii.gz";
  REQUIRE(write_volume(labels, file));
  Driver driver(new_document("", std::make_shared<const Volume>(labels), ball_template(20)), {1280, 2400, 1});
  for (const char* section : {"Template", "Place", "Export"}) driver.app().send(OpenSection{section, true});
  driver.settle();
  const auto before = places(driver);
  const auto moved = [&] {
    std::string paths;
    const auto now = places(driver);
    for (const auto& [path, y] : before)
      if (const auto found = now.find(path); found != now.end() && found->second != y) paths += "\n  " + path;
    return paths;
  };
  driver.app().send(open_labels(file));
  driver.wait_until("the label map is open", [&] {
    return driver.has("Place/Fit to the label") && driver.control("Place/Fit to the label").enabled;
  });
  driver.settle();
  CHECK(moved() == "");
  driver.app().send(StartFit{driver.state().automatic.fit_settings});
  driver.wait_until("the fit runs or is done", [&] { return driver.has("Place/Cancel") || driver.shows("Dice"); });
  CHECK(moved() == "");
  driver.wait_until("the fit is done", [&] { return driver.shows("Dice"); });
  driver.settle();
  CHECK(moved() == "");
  driver.app().send(CloseLabels{});
  driver.settle();
  CHECK(moved() == "");
}

TEST_CASE("nothing below a snap's figures moves when a stroke makes them unknown") {
  const OrganScan scan;
  Driver driver(scan.document(), {1280, 2400, 1});
  driver.click("Snap/Snap the whole mesh");
  driver.wait_until("the mesh has snapped", [&] { return driver.state().found.confidence != nullptr; });
  driver.settle();
  const auto before = places(driver);
  CHECK(driver.control("overlay/Confidence").enabled);
  Stroke pull;
  pull.at = driver.document().view()->shape.points->row(0);
  pull.to = 1.2 * pull.at;
  pull.sigma_mm = 8;
  driver.app().send(ApplyEdit{pull});
  driver.wait_until("the mesh is another", [&] { return driver.state().found.confidence == nullptr; });
  driver.settle();
  std::string moved;
  for (const auto& [path, y] : places(driver))
    if (const auto was = before.find(path); was != before.end() && was->second != y) moved += "\n  " + path;
  CHECK(moved == "");
  CHECK_FALSE(driver.control("overlay/Confidence").enabled);
  CHECK(driver.shows("not known"));
}

TEST_CASE("the section that a person looks at stays when the cine above it gets its curve") {
  Driver driver(BeatingBall::document(), {1280, 800, 1});
  driver.press('L');
  driver.settle();
  const float before = driver.control("side panel/Place").rect.y;
  CHECK(before < 100);
  Stroke pull;
  pull.at = driver.document().view()->shape.points->row(0);
  pull.to = 1.1 * pull.at;
  pull.sigma_mm = 12;
  driver.app().send(ApplyEdit{pull});
  driver.wait_until("the cine has its curve", [&] { return !driver.state().found.volume_curve.frames.empty(); });
  driver.settle();
  CHECK(driver.control("side panel/Place").rect.y == before);
  driver.app().send(ApplyEdit{Undo{}});
  driver.wait_until("the curve is gone", [&] { return driver.state().found.volume_curve.frames.empty(); });
  driver.settle();
  CHECK(driver.control("side panel/Place").rect.y == before);
}

TEST_CASE("the doubt of a fit is an overlay with a legend and a figure") {
  VolumeGeometry grid;
  grid.dims = {50, 50, 50};
  grid.spacing_mm.setConstant(1.6);
  grid.origin_mm.setConstant(-40);
  const TemporaryFolder folder;
  const Volume labels = label_map(icosphere(3, 24), grid, 1);
  const auto file = folder.path / "label.nii.gz";
  REQUIRE(write_volume(labels, file));
  Driver driver(new_document("", std::make_shared<const Volume>(labels), ball_template(20)), {1280, 3600, 1});
  for (const char* section : {"Place", "Correspondence"}) driver.app().send(OpenSection{section, true});
  driver.app().send(open_labels(file));
  driver.wait_until("the label map is open", [&] {
    return driver.has("Place/Fit to the label") && driver.control("Place/Fit to the label").enabled;
  });
  driver.click("Correspondence/overlay/Doubt");
  driver.settle();
  CHECK(driver.shows("not known: a fit to a label map tells it"));

  driver.click("Place/Fit to the label");
  driver.wait_until("the fit is done", [&] { return driver.shows("Dice"); });
  driver.settle();
  CHECK_FALSE(driver.shows("not known: a fit to a label map tells it"));
  driver.wait_until("the figure is there", [&] { return driver.shows(" mm, at most 1"); });
  CHECK(driver.state().look.colouring == Colouring::doubt);
  const Document& document = driver.document();
  REQUIRE(document.view()->shape.doubt_mm);
  const auto colours = mesh_colours(*document.view(), Colouring::doubt, {}, 1);
  // 6 % of the root of the area is 5.1 mm, and so is the scale's end rounded up.
  CHECK(colouring_legend(*document.view(), Colouring::doubt).high == "\xe2\x89\xa5 10 mm");
  CHECK(std::any_of(colours.begin(), colours.end(), [&](const Rgb& one) { return one != colours.front(); }));

  // What a person confirmed is in doubt no more.
  CHECK_FALSE(colouring_legend(*document.view(), Colouring::doubt).has_confirmed);
  driver.app().send(ApplyEdit{Confirm{Vec3::Zero(), 100}});
  driver.wait_until("nothing is in doubt", [&] { return driver.shows("0.0 mm, at most 0.0 mm"); });
  CHECK(colouring_legend(*driver.document().view(), Colouring::doubt).has_confirmed);
}

TEST_CASE("a fit to an organ that the scan cuts marks what is missing in grey") {
  VolumeGeometry grid;
  grid.dims = {50, 50, 50};
  grid.spacing_mm.setConstant(1.6);
  grid.origin_mm.setConstant(-40);
  const TemporaryFolder folder;
  Volume labels = label_map(icosphere(3, 24), grid, 1);
  auto& voxels = std::get<std::vector<std::uint8_t>>(labels.data);
  std::fill(voxels.begin() + 50 * 50 * 32, voxels.end(), std::uint8_t{0});  // above 11 mm
  const auto file = folder.path / "label.nii.gz";
  REQUIRE(write_volume(labels, file));
  Driver driver(new_document("", std::make_shared<const Volume>(labels), ball_template(24)), {1280, 3600, 1});
  for (const char* section : {"Place", "Correspondence"}) driver.app().send(OpenSection{section, true});
  driver.app().send(open_labels(file));
  driver.wait_until("the label map is open", [&] {
    return driver.has("Place/Fit to the label") && driver.control("Place/Fit to the label").enabled;
  });
  CHECK(driver.control("Place/The scan cuts the organ").value == "off");
  driver.click("Place/The scan cuts the organ");
  driver.settle();
  CHECK(driver.state().automatic.fit_settings.partial);
  driver.click("Place/Fit to the label");
  driver.wait_until("the fit is done", [&] { return driver.shows("Missing in the label"); });
  driver.settle();
  CHECK_FALSE(driver.shows("Dice"));
  const Fitted& fitted = *driver.state().found.last_fit;
  CHECK(*fitted.figures.missing_share > 0.1);
  CHECK(fitted.figures.mean_mm < 0.5);  // the flat cut does not count
  CHECK(fitted.figures.p95_mm < 1.6);
  CHECK(driver.shows("the scan lacks this part"));

  const Shape shape = driver.document().view()->shape;
  REQUIRE(shape.outlier);
  const auto top = shape.points->col(2).array() > 16;
  const auto below = shape.points->col(2).array() < 4;
  CHECK((shape.outlier->array() * top.cast<double>()).sum() > 0.9 * static_cast<double>(top.count()));
  CHECK((shape.outlier->array() * below.cast<double>()).sum() == 0);
  const auto greyed = mesh_colours(*driver.document().view(), Colouring::moved, {}, 1);
  Document whole = driver.document();
  test::changed_shape(whole).outlier.reset();
  const auto plain = mesh_colours(*whole.view(), Colouring::moved, {}, 1);
  for (std::size_t i = 0; i < plain.size(); ++i)
    CHECK((greyed[i] == plain[i]) == ((*shape.outlier)[static_cast<Eigen::Index>(i)] == 0));

  driver.app().send(ApplyEdit{Undo{}});
  driver.settle();
  CHECK_FALSE(driver.document().view()->shape.outlier);
  CHECK_FALSE(driver.shows("the scan lacks this part"));
}

TEST_CASE("a section that is opened at the panel's end is scrolled into view") {
  Driver driver(new_document("", nullptr, ball_template(20)), {1024, 700, 1});
  REQUIRE(driver.control("side panel/Export").value == "off");
  driver.click("side panel/Export");
  driver.settle();
  for (const char* name : {"side panel/Export", "Export/Mesh…", "Export/Save the picture…"}) {
    const DrawnItem& item = driver.control(name);
    CHECK_MESSAGE(item.seen.height == item.rect.height, name, " is not in view");
  }
  // One that has room stays where it is.
  driver.click("side panel/Export");
  driver.wheel(100);
  driver.settle();
  const float at = driver.control("side panel/Case").rect.y;
  driver.click("side panel/Case");
  driver.settle();
  driver.click("side panel/Case");
  driver.settle();
  CHECK(driver.control("side panel/Case").rect.y == at);
}

TEST_CASE("a folded section says what is in it") {
  const OrganScan scan;
  Driver driver(scan.document(), {1280, 2400, 1});
  REQUIRE(driver.control("side panel/Place").value == "off");
  CHECK(driver.shows("0 of 3 landmarks"));
  driver.click("side panel/Place");
  CHECK_FALSE(driver.shows("0 of 3 landmarks"));
  if (driver.control("side panel/Template").value == "on") driver.click("side panel/Template");
  CHECK(driver.shows("organ.ply"));
}

namespace {

const DrawnItem* text_named(const Driver& driver, const std::string& words) {
  const auto found = std::find_if(driver.items().begin(), driver.items().end(), [&](const DrawnItem& item) {
    return item.kind == DrawnItem::Kind::text && item.name.find(words) != std::string::npos;
  });
  return found == driver.items().end() ? nullptr : &*found;
}

/// Groups of choices that have no heading right above them.
std::string groups_without_heading(const Driver& driver) {
  std::map<std::string, RectPx> groups;  // where each begins
  for (const DrawnItem& item : driver.items())
    if (item.kind == DrawnItem::Kind::choice) groups.try_emplace(item.path.substr(0, item.path.rfind('/')), item.rect);
  std::string faults;
  for (const auto& [path, first] : groups) {
    const bool headed = std::any_of(driver.items().begin(), driver.items().end(), [&, &rect = first](const auto& item) {
      const float above = rect.y - (item.rect.y + item.rect.height);
      return item.kind == DrawnItem::Kind::text && std::abs(item.rect.x - rect.x) < 6 && above > -2 && above < 14;
    });
    // The modes of the window, and the states of the case whose name stands above, are clear.
    if (!headed && !path.ends_with("mode") && !path.ends_with("state")) faults += path + "\n";
  }
  return faults;
}

}  // namespace

TEST_CASE("every group of choices has a heading") {
  const OrganScan scan;
  const auto labels = scan.folder.path / "label.nii";
  REQUIRE(write_volume(label_map(icosphere(3, 18), OrganScan::grid(), 1), labels));
  Driver driver(scan.document(), {1280, 2600, 1});
  for (const char* section : {"Template", "Place", "Export"}) driver.app().send(OpenSection{section, true});
  driver.app().send(open_labels(labels));
  driver.state().saving.picture.view = ViewKind::axial;
  driver.settle();
  CHECK(groups_without_heading(driver) == "");
  for (const BrushPaints paints : {BrushPaints::factor, BrushPaints::fill}) {
    driver.state().hand.brush.paints = paints;
    for (const MouseTool tool : {MouseTool::stiffness, MouseTool::confirm}) {
      driver.state().hand.tool = tool;
      driver.frames(2);
      CHECK(groups_without_heading(driver) == "");
    }
  }
  driver.app().send(OpenSection{"Pictures", true});
  driver.state().models.shown = true;
  driver.settle();
  CHECK(groups_without_heading(driver) == "");
}

TEST_CASE("fields are as high as the buttons beside them and the rows of stages stand on one line") {
  const OrganScan scan;
  const auto labels = scan.folder.path / "label.nii";
  REQUIRE(write_volume(label_map(icosphere(3, 18), OrganScan::grid(), 1), labels));
  Driver driver(scan.document(), {1280, 1600, 1});
  driver.state().preferences.sections_open = {{"Case", false}, {"Template", true}, {"Deform", false}};
  driver.app().send(ApplyEdit{SetRegion{{"pole", 2, {255, 0, 0}}}});
  driver.settle();
  for (const auto& [field, button] :
       {std::pair("Template/new region", "Template/Add"), std::pair("Template/new landmark", "Template/Name"),
        std::pair("pole/factor", "pole/\xc3\x97")}) {
    CHECK(driver.control(field).rect.y == driver.control(button).rect.y);
    CHECK(driver.control(field).rect.height == driver.control(button).rect.height);
  }
  driver.app().send(open_labels(labels));
  driver.settle();
  driver.state().automatic.template_settings.mask.vertices = 500;
  driver.app().send(MakeTemplate{driver.state().automatic.template_settings, {}});
  driver.wait_until("it is made", [&] { return driver.has("Template/Save and use…"); });
  driver.settle();
  const DrawnItem* name = text_named(driver, "1  ");
  REQUIRE(name != nullptr);
  const auto time = std::find_if(driver.items().begin(), driver.items().end(), [&](const DrawnItem& item) {
    return item.kind == DrawnItem::Kind::text && item.name.ends_with(" s") && std::isdigit(item.name.front()) &&
           std::abs(item.rect.y - name->rect.y) < 12;
  });
  REQUIRE(time != driver.items().end());
  CHECK(time->rect.y == name->rect.y);
}

TEST_CASE("Models says at its foot what comes next and a new study is not called a study's file") {
  const OrganScan scan;
  Driver driver(scan.document());
  driver.state().models.shown = true;
  driver.settle();
  CHECK(driver.shows("Add meshes of one template, or open a study."));
  REQUIRE(write_volume(label_map(icosphere(2, 18), OrganScan::grid(), 1), scan.folder.path / "anna.nii"));
  driver.app().send(AddScans{{scan.folder.path}});
  driver.wait_until("the scan is a case", [&] { return driver.state().models.study.cases.size() == 1; });
  driver.settle();
  CHECK(driver.shows("Cases wait: Fit waiting fits them to their label maps, or open one."));
  CHECK_FALSE(driver.shows("or open a study."));
  driver.click("Study");
  driver.click("study menu/New study…");
  driver.settle();
  CHECK(driver.control("New study/name").value == "cohort.study.json");
}

}  // namespace homolog
