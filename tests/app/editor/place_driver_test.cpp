#include <doctest/doctest.h>

#include <algorithm>

#include "app/editor/state/view_geometry.h"
#include "app/editor/update/controls.h"
#include "app/editor/work/fitter.h"
#include "core/case/held_landmarks.h"
#include "core/catalogue/catalogue.h"
#include "core/measure/compare.h"
#include "core/mesh/construction/clip.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/voxels/label_map.h"
#include "core/model/files/statismo.h"
#include "core/model/shapes/study.h"
#include "core/volume/volume_io.h"
#include "tests/driver.h"
#include "tests/must.h"

// Landmarks and the fit to a label, in the section Place, and how labels are told apart.

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// A ball of 20 mm with two landmarks, and a label map of two balls: label 1 far away, label 2 where the mesh lies.
struct TwoLabels {
  TemporaryFolder folder;
  fs::path labels = folder.path / "labels.nii";
  Document document;

  TwoLabels() {
    const Mesh mesh = icosphere(3, 20);
    MeshFile ball{mesh.points, mesh.topology->triangles()};
    ball.landmarks = {{"north", Vec3(0, 0, 20)}, {"left inferior articular process tip", Vec3(0, 0, -20)}};
    REQUIRE(write_mesh_file(ball, folder.path / "ball.ply"));
    document = new_document("", nullptr, test::must(load_template((folder.path / "ball.ply").string())));
    document.change({}, [&](Structure& first) { first.landmarks.hold = true; });
    VolumeGeometry grid;
    grid.dims = {80, 60, 60};
    grid.origin_mm = Vec3(-29.5, -29.5, -29.5);
    Mesh beside = icosphere(3, 7);
    beside.points.rowwise() += Eigen::RowVector3d(38, 0, 0);
    Volume map = label_map(icosphere(4, 18), grid, 2);
    const Volume other = label_map(beside, grid, 1);
    auto& voxels = std::get<std::vector<std::uint8_t>>(map.data);
    for (std::size_t v = 0; v < voxels.size(); ++v)
      voxels[v] = std::max(voxels[v], std::get<std::vector<std::uint8_t>>(other.data)[v]);
    REQUIRE(write_volume(map, labels));
  }
};

void open_labels_of(Driver& driver, const TwoLabels& two) {
  OpenRequest request;
  request.labels = two.labels;
  driver.app().send(OpenRequested{request});
  driver.wait_until("the label map is open", [&] {
    return driver.has("Place/Fit to the label") && driver.control("Place/Fit to the label").enabled;
  });
  driver.settle();
}

void apply(Driver& driver, Action action) {
  driver.app().send(ApplyEdit{std::move(action), false});
  driver.settle();
}

const DrawnItem& text_that_holds(const Driver& driver, std::string_view words) {
  static const DrawnItem none;
  for (const DrawnItem& item : driver.items())
    if (item.kind == DrawnItem::Kind::text && item.name.find(words) != std::string::npos) return item;
  return none;
}

}  // namespace

TEST_CASE("what landmarks hold does not block a fit and what a person confirmed does until it is freed there") {
  const TwoLabels two;
  Driver driver(two.document);
  driver.click("side panel/Place");
  open_labels_of(driver, two);
  apply(driver, PlaceLandmark{"north", Vec3(0, 0, 19)});
  REQUIRE(landmark_hold(*driver.document().structure()->the_template, 0, driver.document().view()->shape).held);
  CHECK(driver.control("Place/Fit to the label").enabled);
  apply(driver, Confirm{Vec3(20, 0, 0), 8, true});
  CHECK_FALSE(driver.control("Place/Fit to the label").enabled);
  driver.click("Place/Free the confirmed vertices");
  driver.settle();
  CHECK_FALSE(driver.document().view()->shape.confirmed);
  CHECK_FALSE(driver.has("Place/Free the confirmed vertices"));
  CHECK(driver.control("Place/Fit to the label").enabled);
}

TEST_CASE("a fit begins with the label that the mesh lies in and the foot line names the one at the pointer") {
  const TwoLabels two;
  Driver driver(two.document);
  driver.click("side panel/Place");
  open_labels_of(driver, two);
  CHECK(driver.control("Place/label").value == "Label 2");
  driver.click("Place/Fit to the label");
  driver.wait_until("the fit is done", [&] { return driver.document().view()->shape.points->row(0).norm() < 19; });
  CHECK(label_at_mesh(test::must(read_volume(two.labels)).volume, 0, icosphere(2, 500).points) == 0);
}

TEST_CASE("an open template is fitted in the window without a cap and a label map of it says that its rim was closed") {
  const TemporaryFolder folder;
  const auto cup = [](double radius_mm) {
    return clipped(icosphere(4, radius_mm), Vec3::UnitZ(), radius_mm / 3).value();
  };
  const Mesh open = cup(20), organ = cup(24);
  REQUIRE(write_mesh_file(MeshFile{open.points, open.topology->triangles()}, folder.path / "cup.ply"));
  VolumeGeometry grid;
  grid.dims = {60, 60, 60};
  grid.origin_mm.setConstant(-29.5);
  REQUIRE(write_volume(label_map(organ, grid, 1), folder.path / "label.nii"));
  auto image = std::make_shared<Volume>(label_map(organ, grid, 1));
  Driver driver(new_document("", image, test::must(load_template((folder.path / "cup.ply").string()))));
  CHECK(driver.document().view()->mesh().topology->rims().size() == 1);
  driver.click("side panel/Place");
  driver.app().send(OpenRequested{.request = {.labels = folder.path / "label.nii"}});
  driver.wait_until("the label map is open", [&] {
    return driver.has("Place/Fit to the label") && driver.control("Place/Fit to the label").enabled;
  });
  const auto ring_mm = [&] {
    return driver.document().view()->shape.points->leftCols<2>().rowwise().norm().maxCoeff();
  };
  CHECK(ring_mm() < 20.1);
  driver.click("Place/Fit to the label");
  driver.wait_until("the fit is done", [&] { return ring_mm() > 23; });
  driver.settle();
  const Mesh fitted = driver.document().view()->mesh();
  REQUIRE(fitted.topology->rims().size() == 1);
  // It ends at about the edge of the label's flat end, at 8 mm, and does not go on over that.
  for (const std::int32_t i : fitted.topology->rims().front()) {
    CHECK(std::abs(fitted.points(i, 2) - 8) < 5);
    CHECK(fitted.points.row(i).head<2>().norm() > 21);
  }

  driver.app().send(ExportLabelMap{folder.path / "out.nii"});
  driver.wait_until("that is said",
                    [&] { return driver.shows("is open, so its rim was closed flat to have an inside"); });
  const Volume written = test::must(read_volume(folder.path / "out.nii")).volume;
  CHECK(dice_with_mask(fitted, written, 1, 0) == 1);
}

TEST_CASE("the label list and the foot line name labels as the map does") {
  const TwoLabels two;
  write_bytes(two.labels.parent_path() / "labels.json", R"({"1": "spleen", "2": "left kidney"})");
  Driver driver(two.document);
  driver.click("side panel/Place");
  open_labels_of(driver, two);
  CHECK(driver.control("Place/label").value == "left kidney (2)");
}

TEST_CASE("a fit begins with the shape of the study's model or of a file's and says how near that alone comes") {
  const TemporaryFolder folder;
  Study study;
  for (int k = 0; k < 3; ++k) {
    Mesh ball = icosphere(3, 20);
    ball.points.col(0) *= 1 + 0.15 * k;
    ball.points.col(1) *= k == 2 ? 1.1 : 1.0;
    StudyCase one;
    one.name = "ball " + std::to_string(k);
    one.file = folder.path / (std::to_string(k) + ".ply");
    REQUIRE(write_mesh(ball, one.file));
    study.cases.push_back(one);
  }
  REQUIRE(write_study(study, folder.path / "balls.study.json"));
  Mesh long_ball = icosphere(4, 20);
  long_ball.points.col(0) *= 1.2;
  VolumeGeometry grid;
  grid.dims = {60, 60, 60};
  grid.origin_mm.setConstant(-29.5);
  REQUIRE(write_volume(label_map(long_ball, grid, 1), folder.path / "label.nii"));

  Driver driver(new_document("", nullptr, test::must(load_template(study.cases[0].file.string()))), {1280, 1400, 1});
  driver.state().models.shown = true;
  driver.app().send(OpenStudy{{folder.path / "balls.study.json"}});
  driver.wait_until("the study has a model", [&] { return driver.state().models.made.model != nullptr; });
  driver.state().models.shown = false;
  driver.app().send(open_labels(folder.path / "label.nii"));
  driver.click("side panel/Place");
  driver.wait_until("the label map is open", [&] {
    return driver.has("Place/Fit to the label") && driver.control("Place/Fit to the label").enabled;
  });
  const auto fit = [&] {
    driver.click("Place/Fit to the label");
    driver.wait_until("the fit is done", [&] { return driver.state().found.last_fit.has_value(); });
    driver.settle();
    CHECK(driver.shows("The model alone comes within"));
    CHECK(driver.state().found.last_fit->figures.mean_mm < 0.6);
    driver.press('Z', {false, true, false});
    driver.settle();
    driver.state().found.last_fit.reset();
  };
  driver.click("fit model/Study's");
  fit();
  REQUIRE(write_model(driver.state().models.made.model->model, folder.path / "balls.h5.json"));
  driver.click("fit model/File's");
  CHECK_FALSE(driver.control("Place/Fit to the label").enabled);
  driver.click("Choose the model…");
  driver.type_into("name", (folder.path / "balls.h5.json").string());
  driver.press(key::enter);
  driver.wait_until("the model is read", [&] { return driver.state().automatic.fit_model != nullptr; });
  fit();
}

TEST_CASE("how far a landmark is off stands beside its buttons and its name ends before it") {
  const TwoLabels two;
  Driver driver(two.document);
  driver.click("side panel/Place");
  apply(driver, SetLandmarkPull{LandmarkPull::off});
  apply(driver, PlaceLandmark{"left inferior articular process tip", Vec3(0, 0, -26)});
  driver.point_at("left inferior articular process tip/row");
  const DrawnItem& off = text_that_holds(driver, "mm off");
  REQUIRE(!off.name.empty());
  CHECK(off.rect.x + off.rect.width <= driver.control("left inferior articular process tip/hold").rect.x);
  CHECK(driver.control("left inferior articular process tip/row").tip.find("the place that you clicked") !=
        std::string::npos);
}

TEST_CASE("once a landmark of the template has its place the tool from before is in hand and the next can be named") {
  const TwoLabels two;
  Driver driver(two.document);
  driver.press('S');
  const MouseTool before = driver.state().hand.tool;
  REQUIRE(before != MouseTool::pull);
  driver.click("side panel/Template");
  driver.type_into("new landmark", "east");
  driver.press(key::enter);
  driver.settle();
  CHECK(driver.state().hand.tool == MouseTool::template_landmark);
  const auto click_mesh = [&](double aside_px) {
    const RectPx& view = driver.app().layout().image(ViewKind::space);
    driver.move(view.x + view.width / 2 + aside_px, view.y + view.height / 2);
    driver.button(MouseButton::left, true);
    driver.button(MouseButton::left, false);
    driver.settle();
  };
  click_mesh(0);
  CHECK(driver.document().structure()->the_template->landmarks.size() == 3);
  CHECK(driver.control("new landmark").value.empty());
  CHECK(driver.state().hand.tool == before);
  CHECK_FALSE(driver.shows("Type a landmark's name"));

  driver.click("Move or remove landmarks…");
  CHECK(driver.shows("Type a landmark's name, or choose one in the list to move it (Template)."));
  driver.click("Template/east/east");
  const Points& points = *driver.document().view()->shape.points;
  const auto east = [&] { return carried_landmark(*driver.document().structure()->the_template, 2, points); };
  const Vec3 was = east();
  click_mesh(20);
  CHECK((east() - was).norm() > 0.5);
  CHECK(driver.state().hand.tool == MouseTool::template_landmark);  // the list stays for the next
  driver.click("Done with landmarks");
  CHECK(driver.state().hand.tool == before);
}

TEST_CASE("a template is made of the label that the mesh lies in or else the cross-hair until one is chosen") {
  const TwoLabels two;
  {
    Driver driver(two.document);
    driver.click("side panel/Template");
    driver.app().send(open_labels(two.labels));
    driver.wait_until("the label map is open", [&] {
      return driver.has("Template/Make the template") && driver.control("Template/Make the template").enabled;
    });
    driver.settle();
    CHECK(driver.control("Template/label").value == "Label 2");
    driver.click("Template/label");
    driver.click("label/Label 1");
    driver.settle();
    CHECK(driver.control("Template/label").value == "Label 1");
    CHECK(driver.state().automatic.template_settings.label == 1);
  }
  const auto map = std::make_shared<const Volume>(test::must(read_volume(two.labels)).volume);
  Driver driver(new_document(two.labels.string(), map, nullptr));
  driver.app().send(open_labels(two.labels));
  driver.wait_until("the label map is open", [&] {
    return driver.has("Template/Make the template") && driver.control("Template/Make the template").enabled;
  });
  driver.state().look.crosshair_mm = Vec3(5, 5, 0);
  driver.frames(2);
  CHECK(driver.control("Template/label").value == "Label 2");
  driver.state().look.crosshair_mm = Vec3(34, 3, 0);
  driver.frames(2);
  CHECK(driver.control("Template/label").value == "Label 1");
  driver.click("Template/Make the template");
  driver.wait_until("it is made", [&] { return driver.has("Save and use…"); });
  driver.settle();
  CHECK((driver.state().look.crosshair_mm - Vec3(38, 0, 0)).norm() < 2);  // the views look at what is made
}

TEST_CASE("what came of a fit alone is called an edit and no stroke") {
  const TwoLabels two;
  Driver driver(two.document);
  SetPoints fitted;
  fitted.points = std::make_shared<const Points>(0.9 * *driver.document().view()->shape.points);
  apply(driver, fitted);
  CHECK_FALSE(text_that_holds(driver, "Edits of the mesh").name.empty());
  CHECK(text_that_holds(driver, "Strokes").name.empty());
  apply(driver, PlaceLandmark{"north", Vec3(0, 0, 25)});
  CHECK(driver.shows("Once the mesh was edited or fitted, landmarks no longer move it."));
}

TEST_CASE("the key L scrolls the panel to the landmarks") {
  const TwoLabels two;
  Driver driver(two.document, {1280, 600, 1});
  driver.click("side panel/Template");  // open, it pushes Place down
  driver.press('L');
  driver.settle();
  const RectPx& panel = driver.app().layout().panel;
  const RectPx& title = driver.control("side panel/Place").rect;
  CHECK(title.y >= panel.y - 1);
  CHECK(title.y < panel.y + 40);
  CHECK(driver.has("north/row"));
}

TEST_CASE("looking at a place keeps the patient upright however the camera was rolled") {
  Camera3D camera;
  camera.to_eye = Vec3(0, -1, 0);
  camera.up = Vec3(1, 0, 0);
  look_from_outside(camera, Vec3(1, 1, 0.2));
  CHECK(camera.up.z() > 0.9);
  CHECK(std::abs(camera.up.dot(camera.to_eye)) < 1e-9);
  look_from_outside(camera, Vec3(0, 0, 1));
  CHECK(camera.up.y() < -0.9);
}

}  // namespace homolog
