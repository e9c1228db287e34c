#include <doctest/doctest.h>

#include <cmath>
#include <fstream>

#include "app/editor/state/models/gallery.h"
#include "app/editor/update/editing.h"
#include "app/editor/work/models/build_study_model.h"
#include "app/editor/work/models/study_folder.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/construction/mirror.h"
#include "core/mesh/mesh_io.h"
#include "tests/changed_shape.h"
#include "tests/must.h"
#include "tests/temporary_folder.h"

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// Spheres that differ by their radius along x, y and z, with one group of two larger than the other by 1 mm.
struct Balls {
  TemporaryFolder folder;
  ModelsState state;

  fs::path write(const std::string& name, const Vec3& radii_mm, int subdivisions = 2) {
    Mesh mesh = icosphere(subdivisions);
    mesh.points = mesh.points * radii_mm.asDiagonal();
    const fs::path path = folder.path / (name + ".ply");
    test::must(write_mesh(mesh, path).map([] { return 0; }));
    return path;
  }
  Balls() {
    add_cases(state, {write("a1", {10, 10, 10.5}), write("a2", {10, 10, 9.5}), write("b1", {11, 11, 11.5}),
                      write("b2", {11, 11, 10.5})});
    for (StudyCase& one : state.study.cases) one.group = one.name.substr(0, 1);
  }
  StudyModelBuilt build(Alignment alignment = Alignment::rigid) {
    Progress progress;
    StudyModelRequest request;
    request.cases = state.study.cases;
    request.alignment = alignment;
    return build_study_model(request, progress);
  }
  /// With the model in it.
  ModelsState& modelled() {
    show_model(state, build().model);
    REQUIRE(state.made.model);
    return state;
  }
};

}  // namespace

TEST_CASE("cases are named after their files and never twice") {
  ModelsState state;
  CHECK(add_cases(state, {"/one/knee.ply", "/two/knee.ply", "/one/knee.ply"}) == 2);
  REQUIRE(state.study.cases.size() == 2);
  CHECK(state.study.cases[0].name == "knee");
  CHECK(state.study.cases[1].name == "knee-2");
  const auto before = state.kept.shapes_revision;
  CHECK(add_cases(state, {"/two/../two/knee.ply"}) == 0);
  CHECK(state.kept.shapes_revision == before);
}

TEST_CASE("the list of cases is filtered by name group and notes and sorted either way") {
  ModelsState state;
  add_cases(state, {"/c.ply", "/a.ply", "/b.ply"});
  set_case_text(state, "a", "group", "Healthy");
  set_case_text(state, "b", "notes", "healthy too?");
  using Listed = std::vector<std::size_t>;
  CHECK(listed_cases(state) == Listed{0, 1, 2});
  sort_by(state, CaseColumn::name);
  CHECK(listed_cases(state) == Listed{1, 2, 0});
  sort_by(state, CaseColumn::name);
  CHECK(listed_cases(state) == Listed{0, 2, 1});
  sort_by(state, CaseColumn::name);
  CHECK(listed_cases(state) == Listed{0, 1, 2});
  state.list.filter = "HEALTHY";
  CHECK(listed_cases(state) == Listed{1, 2});
}

TEST_CASE("the next case is the next that is not done") {
  ModelsState state;
  add_cases(state, {"/a.ply", "/b.ply", "/c.ply"});
  const auto revision = state.kept.shapes_revision;
  cycle_case_state(state, "b");
  cycle_case_state(state, "b");
  CHECK(find_case(state.study, "b")->state == CaseState::done);
  CHECK(state.kept.shapes_revision == revision);
  // One of a scan is in no model while it waits.
  state.study.cases[2].from_scan = true;
  cycle_case_state(state, "c");
  CHECK(state.kept.shapes_revision == revision + 1);
  cycle_case_state(state, "c");
  CHECK(state.kept.shapes_revision == revision + 1);
  cycle_case_state(state, "c");
  CHECK(state.kept.shapes_revision == revision + 2);
  select_next_case(state);
  CHECK(state.list.selected == "a");
  select_next_case(state);
  CHECK(state.list.selected == "c");
  select_next_case(state);
  CHECK(state.list.selected == "a");
}

TEST_CASE("a shape out of correspondence and one that cannot be read are left out by name") {
  Balls balls;
  add_cases(balls.state, {balls.write("coarse", Vec3::Constant(10), 1), balls.folder.path / "absent.ply"});
  const StudyModelBuilt built = balls.build();
  REQUIRE(built.model);
  CHECK(built.model->names == std::vector<std::string>{"a1", "a2", "b1", "b2"});
  REQUIRE(built.refusals.size() == 2);
  CHECK(built.refusals[0].find("absent.ply") != std::string::npos);
  CHECK(built.refusals[1].find("coarse") != std::string::npos);
}

TEST_CASE("shapes that are known already are not read again") {
  Balls balls;
  Progress progress;
  StudyModelRequest request;
  request.cases = balls.state.study.cases;
  const StudyModelBuilt first = build_study_model(request, progress);
  request.known = first.known;
  REQUIRE(request.known.size() == 4);
  const auto again = build_study_model(request, progress);
  REQUIRE(again.shapes.size() == 4);
  for (const auto& [name, shape] : again.shapes) CHECK(shape == first.shapes.at(name));
}

TEST_CASE("what is confirmed in the open case is so in the study") {
  Balls balls;
  const fs::path file = balls.folder.path / "c.homolog";
  std::ofstream(file) << "there is a file";
  const auto the_template = test::must(load_template((balls.folder.path / "a1.ply").string()));
  auto open = std::make_shared<Document>(new_document("", nullptr, the_template));
  REQUIRE(open->view());
  add_cases(balls.state, {file});
  Progress progress;
  StudyModelRequest request;
  request.cases = balls.state.study.cases;
  request.open_file = file;
  request.open_document = open;
  const StudyModelBuilt before = build_study_model(request, progress);
  REQUIRE(before.shapes.contains("c"));
  request.known = before.known;
  CHECK(build_study_model(request, progress).shapes.at("c") == before.shapes.at("c"));
  auto confirmed = std::make_shared<Document>(*open);
  test::changed_shape(*confirmed).confirmed =
      std::make_shared<const VertexScalars>(VertexScalars::Ones(the_template->points.rows()));
  request.open_document = confirmed;
  const StudyModelBuilt after = build_study_model(request, progress);
  CHECK(after.shapes.at("c")->arrays.contains("confirmed"));
  CHECK_FALSE(same_shape(*after.shapes.at("c"), *before.shapes.at("c")));
}

TEST_CASE("what was optimised is over when the shapes or their alignment are others") {
  Balls balls;
  const auto shapes_of_study = [&] {
    StudyModelBuilt built = balls.build(Alignment::similarity);
    REQUIRE(built.model);
    return ShapesOfStudy{std::move(built.shapes), std::move(built.sizes), std::move(built.model)};
  };
  const StudyToOptimise of{shapes_of_study(), Alignment::similarity};
  const auto why = [&](const ShapesOfStudy& now) { return why_outdated(of, now, Alignment::similarity); };
  CHECK(why(shapes_of_study()).empty());
  CHECK(why_outdated(of, of.fitted, Alignment::rigid) == "the alignment was changed");
  ShapesOfStudy now = of.fitted;
  MeshFile moved = *now.shapes.at("a2");
  moved.landmarks.push_back({"pole", Vec3(0, 0, 9.5)});
  now.shapes["a2"] = std::make_shared<const MeshFile>(moved);
  CHECK(why(now) == "a2 has changed");
  find_case(balls.state.study, "b2")->flipped = true;
  CHECK(why(shapes_of_study()) == "b2 has changed");
  find_case(balls.state.study, "b2")->flipped = false;
  remove_case(balls.state, "b1");
  CHECK(why(shapes_of_study()) == "b1 is not in the model any more");
  add_cases(balls.state, {balls.write("c", {12, 11, 11})});
  CHECK(why(shapes_of_study()) == "c was added");
  CHECK(why({}) == "a1 is not in the model any more");

  // The state drops it too, and shows what was fitted.
  ModelsState& state = balls.state;
  CHECK(take_fitted(state, of.fitted).empty());
  state.made.optimisation.of = std::make_shared<const StudyToOptimise>(of);
  take_optimised(state, {of.fitted, {}, {}, 1, 1});
  CHECK(state.made.optimisation.shown);
  CHECK(take_fitted(state, shapes_of_study()) ==
        "The optimised shapes were dropped, because c was added. Optimise again.");
  CHECK_FALSE(state.made.optimisation.of);
  CHECK(state.made.model == state.shapes.fitted.model);
}

TEST_CASE("a mirrored shape is listed and no more once it is flipped") {
  Balls balls;
  MeshFile lopsided;
  for (const std::string name : {"a1", "a2", "b1", "b2"}) {
    lopsided = test::must(read_mesh_file(balls.folder.path / (name + ".ply")));
    for (Eigen::Index v = 0; v < lopsided.points.rows(); ++v) {
      const Vec3 p = lopsided.points.row(v);
      lopsided.points.row(v) += 0.05 * Eigen::RowVector3d(p.y() * p.y(), p.x() * p.z(), p.x() * p.y());
    }
    if (name == "b1") lopsided = mirrored(lopsided);
    test::must(write_mesh_file(lopsided, balls.folder.path / (name + ".ply")).map([] { return 0; }));
  }
  CHECK(balls.build().mirrored == std::vector<std::string>{"b1"});
  flip_cases(balls.state, {"b1"});
  CHECK(balls.build().mirrored.empty());
  flip_cases(balls.state, {"b1"});
  CHECK_FALSE(find_case(balls.state.study, "b1")->flipped);
}

TEST_CASE("the other frames of a cine become cases beside the first") {
  ModelsState state;
  add_cases(state, {"/heart.homolog", "/knee.ply"});
  CHECK(other_frames(state, state.study.cases[0]).empty());
  ReadFile file;
  file.shapes.structures.push_back({"s1", {}, {0, 2, 3}});
  file.shapes.shown = 2;
  state.shapes.files["/heart.homolog"] = file;
  CHECK(other_frames(state, state.study.cases[0]) == std::vector<int>{0, 3});
  add_frames(state, "heart");
  std::vector<std::string> names;
  for (const StudyCase& one : state.study.cases) names.push_back(one.name);
  CHECK(names == std::vector<std::string>{"heart", "heart frame 0", "heart frame 3", "knee"});
  CHECK(state.study.cases[0].frame == 2);
  CHECK(other_frames(state, state.study.cases[0]).empty());
}

TEST_CASE("a study's template gives shapes of points alone their faces") {
  Balls balls;
  ModelsState points;
  for (const char* name : {"a1", "a2", "b1"}) {
    MeshFile mesh = test::must(read_mesh_file(balls.folder.path / (std::string(name) + ".ply")));
    mesh.triangles.edit().resize(0, 3);
    const fs::path path = balls.folder.path / (std::string(name) + ".particles");
    test::must(write_mesh_file(mesh, path).map([] { return 0; }));
    add_cases(points, {path});
  }
  Progress progress;
  StudyModelRequest request;
  request.cases = points.study.cases;
  CHECK_FALSE(build_study_model(request, progress).model->topology);
  request.template_file = balls.folder.path / "b2.ply";
  CHECK(build_study_model(request, progress).model->topology);
  request.template_file = balls.write("coarse", Vec3::Constant(10), 1);
  const StudyModelBuilt built = build_study_model(request, progress);
  CHECK_FALSE(built.model->topology);
  REQUIRE(built.warnings.size() == 1);
  CHECK(built.warnings[0].find("coarse.ply") != std::string::npos);
}

TEST_CASE("the difference of two groups is how far one lies outside the other") {
  Balls balls;
  const ModelsState& state = balls.modelled();
  REQUIRE(state.made.model->comparable_groups() == std::vector<std::string>{"a", "b"});
  const VertexScalars difference_mm = difference_of_groups_mm(*state.made.model, "a", "b");
  CHECK(difference_mm.minCoeff() > 0.98);
  CHECK(difference_mm.maxCoeff() < 1.02);
  CHECK((difference_of_groups_mm(*state.made.model, "b", "a") + difference_mm).norm() < 1e-9);
}

TEST_CASE("a case's coefficients give its shape back and stay within three standard deviations") {
  Balls balls;
  ModelsState& state = balls.modelled();
  set_to_case(state, "b1");
  const Points shape = shape_of(state.made.model->model, shown_coefficients(state));
  CHECK((shape - state.made.model->shape(2)).rowwise().norm().maxCoeff() < 0.2);
  for (int draw = 0; draw < 50; ++draw) {
    set_to_sample(state);
    for (const double deviation : state.view.deviations) CHECK(std::abs(deviation) <= 3);
  }
  set_to_mean(state);
  CHECK(shown_coefficients(state).norm() == 0);
}

TEST_CASE("a landmark that is looked at is in the middle of every cell and faces the viewer") {
  Balls balls;
  ModelsState& state = balls.modelled();
  const GalleryGrid grid = gallery_grid(state.made.model->names.size(), {100, 50, 640, 480});
  const double distance_mm = state.gallery.camera.distance_mm;
  pin_vertex(state, {1, 17}, true);
  CHECK(state.list.selected == "a2");
  for (std::size_t k = 0; k < grid.shapes; ++k) {
    const Points points = state.made.model->shape(k);
    const RectPx cell = grid.cell(k);
    const Eigen::Vector2d px = cell_px(cell_camera(state, points), cell, points.row(17));
    CHECK(std::abs(px.x() - cell.x - cell.width / 2) < 1);
    CHECK(std::abs(px.y() - cell.y - cell.height / 2) < 1);
    CHECK(faces_viewer(state.gallery.camera, {state.made.model->topology, points}, 17));
    const auto found = vertex_at(state, grid, px.x(), px.y(), 1);
    REQUIRE(found);
    CHECK(*found == GalleryVertex{k, 17});
  }
  unpin(state);
  CHECK_FALSE(state.gallery.pinned);
  show_all_shapes(state);
  CHECK(state.gallery.camera.distance_mm == doctest::Approx(distance_mm));
}

TEST_CASE("cells of a gallery fill its area without overlapping") {
  for (const std::size_t count : {1u, 7u, 24u, 200u}) {
    const GalleryGrid grid = gallery_grid(count, {10, 20, 640, 660});
    CHECK(static_cast<std::size_t>(grid.columns * grid.rows) >= count);
    for (std::size_t k = 0; k < count; ++k) {
      const RectPx cell = grid.cell(k);
      CHECK(grid.shape_at(cell.x + 1, cell.y + 1) == k);
      CHECK(cell.x + cell.width <= 650);
      CHECK(cell.y + cell.height <= 680);
    }
  }
}

TEST_CASE("the gallery shows as many shapes as a page holds and the page of what is selected") {
  ModelsState state;
  TrainingSet set;
  const Mesh ball = icosphere(1, 10);
  constexpr std::size_t count = 2 * shapes_a_page + 1;
  set.topology = ball.topology;
  set.shapes.resize(ball.points.size(), count);
  for (std::size_t k = 0; k < count; ++k) {
    Points points = ball.points;
    points.col(0) *= 1 + 0.01 * static_cast<double>(k);
    set.names.push_back("ball-" + std::to_string(k));
    set.shapes.col(static_cast<Eigen::Index>(k)) = points.reshaped<Eigen::RowMajor>();
  }
  const Progress progress;
  show_model(state, test::must(make_study_model(set, std::vector<std::string>(count), Alignment::none, progress)));
  CHECK(gallery_pages(state) == 3);
  const RectPx area{10, 20, 640, 480};
  const GalleryGrid first = page_grid(state, area);
  CHECK(first.first == 0);
  CHECK(first.shapes == shapes_a_page);
  show_gallery_page(state, 7);
  CHECK(state.gallery.page == 2);
  const GalleryGrid last = page_grid(state, area);
  CHECK(last.shapes == 1);
  const RectPx cell = last.cell(count - 1), same = first.cell(0);
  CHECK(cell.x == same.x);
  CHECK(cell.width == same.width);
  CHECK(last.shape_at(cell.x + 1, cell.y + 1) == count - 1);
  CHECK_FALSE(last.shape_at(cell.x + cell.width + 10, cell.y + 1));
  select_case(state, "ball-" + std::to_string(shapes_a_page));
  CHECK(state.gallery.page == 1);
  pin_vertex(state, {3, 5}, false);
  CHECK(state.gallery.page == 0);
  CHECK((state.made.model->shape(3) - Points(points_of(set.shapes, 3))).norm() < 1e-12);
}

TEST_CASE("Tab exchanges case and models and in the models the tools' keys do nothing") {
  EditorState state;
  Outbox out;
  const Document document = new_document({}, nullptr, nullptr);
  const Layout layout = make_layout(1280, 800, 1, {});
  ShownMesh mesh;
  const auto press = [&](int key) {
    const ControlsContext context{layout, document, mesh, false, false};
    press_key(state, {KeyPress{key}, 0, 0, false, false, false, 0, true}, key, context, out);
    for (const Command& command : out.take()) command.run_on_state(state, context, out);
  };
  press('G');
  CHECK(state.hand.tool == MouseTool::grab);
  press(key::tab);
  CHECK(state.models.shown);
  press('P');
  CHECK(state.hand.tool == MouseTool::grab);
  press(key::tab);
  CHECK_FALSE(state.models.shown);
}

TEST_CASE("a phantom study is written once and then kept as the user left it") {
  const TemporaryFolder folder;
  Progress progress;
  const fs::path path = test::must(make_phantom_study(Organ::vertebra, folder.path, progress));
  auto read = test::must(read_study(path));
  CHECK(read.warnings.empty());
  REQUIRE(read.study.cases.size() == 10);
  read.study.cases[3].notes = "odd";
  test::must(write_study(read.study, path).map([] { return 0; }));
  CHECK(test::must(make_phantom_study(Organ::vertebra, folder.path, progress)) == path);
  CHECK(test::must(read_study(path)).study.cases[3].notes == "odd");
}

}  // namespace homolog
