#include <doctest/doctest.h>

#include "core/mesh/mesh_io.h"
#include "core/session/case_file.h"
#include "core/structures/fitting/keep_apart.h"
#include "core/volume/labels/read_labels.h"

#include "tests/desk.h"
#include "tests/driver.h"

// A case of several structures in the window: what is done by hand goes to the one that is worked on.

namespace homolog {

namespace {

/// A second kidney, half as large and beside the first.
SetStructure small_kidney(const Document& document) {
  const ShapeView first = *document.view();
  const Similarity placed = first.shape.placement;
  const Vec3 middle = bounds_of(*first.shape.points).center();
  Similarity half = placed;
  half.scale = placed.scale / 2;
  half.translation = placed.translation / 2 + middle / 2 + Vec3(30, 0, 0);
  return {.id = "s2",
          .name = "small kidney",
          .source = first.the_template().source,
          .placement = half,
          .the_template = first.structure.the_template};
}

Points points_of(const Driver& driver, const char* id) {
  return *driver.document().view(id)->shape.points;
}

void start_with_two(Driver& driver) {
  driver.app().send(ApplyEdit{small_kidney(driver.document())});
  driver.wait_until("there are two structures", [&] { return driver.document().structures.size() == 2; });
  driver.settle();
}

/// The px of an axial slice where a vertex lies that is nearest to the slice.
std::array<double, 2> on_axial_outline(Driver& driver, const char* id) {
  const Points points = points_of(driver, id);
  driver.state().look.crosshair_mm = points.row(0).transpose();
  driver.settle();
  const auto px = view_map(driver.state(), driver.app().layout(), driver.document(), ViewKind::axial)
                      .to_px(points.row(0).transpose());
  REQUIRE(px);
  return {px->x(), px->y()};
}

}  // namespace

TEST_CASE("what a hand pulls is the structure that is worked on") {
  Driver driver(demo());
  start_with_two(driver);
  driver.app().send(KeepApartAfterStrokes{false});
  const Points first = points_of(driver, "s1"), second = points_of(driver, "s2");

  driver.app().send(ChooseStructure{"s2"});
  driver.settle();
  CHECK(driver.state().look.structure == "s2");
  const auto [x, y] = on_axial_outline(driver, "s2");
  driver.move(x, y);
  driver.frame();
  REQUIRE(driver.state().pointer.hover->on_mesh);
  driver.button(MouseButton::left, true);
  driver.move(x + 12, y + 4);
  driver.frame();
  driver.button(MouseButton::left, false);
  driver.settle();
  CHECK(points_of(driver, "s1") == first);
  CHECK((points_of(driver, "s2") - second).rowwise().norm().maxCoeff() > 1);
  CHECK(driver.lines_with(R"("of":"s2")") == 1);

  driver.app().send(ChooseStructure{});
  driver.settle();
  CHECK(driver.state().look.structure.empty());
  driver.app().send(ApplyEdit{SetStiffnessBase{7}});
  driver.settle();
  CHECK(driver.document().structure("s1")->paint.base == 7);
  CHECK(driver.document().structure("s2")->paint.base == 3);
  CHECK(driver.lines_with(R"("of":"s2")") == 1);
}

TEST_CASE("a drag stays with its structure whatever keys are pressed") {
  Driver driver(demo());
  start_with_two(driver);
  driver.app().send(KeepApartAfterStrokes{false});
  driver.settle();
  const Points first = points_of(driver, "s1"), second = points_of(driver, "s2");
  const auto [x, y] = on_axial_outline(driver, "s1");
  driver.move(x, y);
  driver.frame();
  driver.button(MouseButton::left, true);
  driver.move(x + 12, y + 4);
  driver.frame();
  for (const int key : {static_cast<int>('E'), static_cast<int>('K'), static_cast<int>('N'), key::tab, key::enter}) {
    driver.press(key);
    driver.frame();
  }
  CHECK(driver.state().look.structure.empty());
  CHECK_FALSE(driver.state().models.shown);
  driver.button(MouseButton::left, false);
  driver.settle();
  CHECK(points_of(driver, "s2") == second);
  CHECK((points_of(driver, "s1") - first).rowwise().norm().maxCoeff() > 1);
  driver.press('E');
  driver.settle();
  CHECK(driver.state().look.structure == "s2");
}

TEST_CASE("a saved template of another structure is not that of new images") {
  Driver driver(demo());
  start_with_two(driver);
  const std::string source = driver.document().structure()->the_template->source;
  driver.app().send(ChooseStructure{"s2"});
  driver.settle();
  driver.app().send(ExportTemplate{driver.folder() / "second.ply"});
  driver.wait_until("it is written", [&] { return driver.shows("Written: "); });
  driver.settle();
  CHECK_FALSE(driver.shows("The case goes on with"));
  driver.click("side panel/Template");
  CHECK_FALSE(driver.shows("mirrored)"));
  CHECK(driver.document().structure()->the_template->source == source);
}

TEST_CASE("after a stroke the structure goes out of its neighbour, and both are one step to undo") {
  Driver driver(demo());
  start_with_two(driver);
  driver.app().send(ChooseStructure{"s2"});
  driver.settle();
  const auto& topology = driver.document().view()->the_template().topology;
  const auto depth = [&] {
    const Mesh first{topology, points_of(driver, "s1")}, second{topology, points_of(driver, "s2")};
    return depth_mm(second, first, 5);
  };
  // It is moved to where it lies some millimetres within the other, and then pulled a little.
  const Vec3 way = bounds_of(points_of(driver, "s1")).center() - bounds_of(points_of(driver, "s2")).center();
  Points moved = points_of(driver, "s2");
  for (int steps = 0; steps < 60 && depth_mm({topology, moved}, {topology, points_of(driver, "s1")}, 5) < 3; ++steps)
    moved.rowwise() += way.normalized().transpose();
  driver.app().send(ApplyEdit{SetPoints{FoundBy::fit, std::nullopt, std::make_shared<const Points>(moved)}});
  driver.settle();
  const double within_mm = depth();
  REQUIRE(within_mm > 2);
  const Points first = points_of(driver, "s1"), before = points_of(driver, "s2");
  const auto pull = [&] {
    const auto [x, y] = on_axial_outline(driver, "s2");
    driver.move(x, y);
    driver.frame();
    REQUIRE(driver.state().pointer.hover->on_mesh);
    driver.button(MouseButton::left, true);
    driver.move(x + 2, y);
    driver.frame();
    driver.button(MouseButton::left, false);
    driver.settle();
  };
  pull();
  CHECK(depth() < 0.1);
  CHECK(points_of(driver, "s1") == first);
  driver.press('Z', {.ctrl = true});
  driver.settle();
  CHECK(points_of(driver, "s2") == before);
  driver.app().send(SetStructureGap{2});
  driver.settle();
  pull();
  CHECK(depth() < -1.8);
  driver.press('Z', {.ctrl = true});
  driver.settle();
  CHECK(points_of(driver, "s2") == before);
  driver.app().send(KeepApartAfterStrokes{false});
  driver.settle();
  pull();
  CHECK(depth() > 2);
}

namespace {

/// A kidney of half the size, whose vertex 0 is that of the first, and which is hidden.
void start_with_shared(Driver& driver) {
  SetStructure half = small_kidney(driver.document());
  const ShapeView first = *driver.document().view();
  const Vec3 from_origin = half.placement->apply(half.the_template->points).row(0).transpose();
  half.placement->translation += first.shape.points->row(0).transpose() - from_origin;
  driver.app().send(ApplyEdit{std::move(half)});
  driver.wait_until("there are two structures", [&] { return driver.document().structures.size() == 2; });
  const auto same = std::make_shared<const std::vector<VertexPair>>(std::vector<VertexPair>{{0, 0}});
  driver.app().send(ApplyEdit{SetStructure{.id = "s2", .shared = {{SharedWith{"s1", same}}}}});
  driver.app().send(KeepApartAfterStrokes{false});
  driver.app().send(ShowStructures{{"s2"}, false});
  driver.settle();
  REQUIRE(driver.document().structure("s2")->shared.size() == 1);
}

void pull_vertex_0(Driver& driver) {
  const auto [x, y] = on_axial_outline(driver, "s1");
  driver.move(x, y);
  driver.frame();
  REQUIRE(driver.state().pointer.hover->on_mesh);
  driver.button(MouseButton::left, true);
  driver.move(x + 12, y + 4);
  driver.frame();
  driver.button(MouseButton::left, false);
  driver.settle();
}

double shared_apart_mm(const Driver& driver) {
  return (points_of(driver, "s1").row(0) - points_of(driver, "s2").row(0)).norm();
}

}  // namespace

TEST_CASE("where a vertex is pulled that another structure shares that one follows, and both are one step to undo") {
  Driver driver(demo());
  start_with_shared(driver);
  const Points first = points_of(driver, "s1"), second = points_of(driver, "s2");
  REQUIRE(shared_apart_mm(driver) < 1e-6);
  pull_vertex_0(driver);
  const Points pulled = points_of(driver, "s1"), followed = points_of(driver, "s2");
  CHECK((pulled.row(0) - first.row(0)).norm() > 1);
  CHECK(shared_apart_mm(driver) < 1e-6);
  CHECK(driver.lines_with("shared vertices") > 0);
  // What lies around goes along, less with every ring; what is far away stays.
  const Topology& topology = *driver.document().structure("s2")->the_template->topology;
  const double whole_mm = (followed.row(0) - second.row(0)).norm();
  for (const std::int32_t v : topology.one_ring(0)) {
    const double mm = (followed.row(v) - second.row(v)).norm();
    CHECK(mm > 0);
    CHECK(mm < whole_mm);
  }
  Eigen::Index far = 0;
  (second.rowwise() - second.row(0)).rowwise().norm().maxCoeff(&far);
  CHECK(followed.row(far) == second.row(far));

  driver.press('Z', {.ctrl = true});
  driver.settle();
  CHECK(points_of(driver, "s1") == first);
  CHECK(points_of(driver, "s2") == second);
  driver.press('Y', {.ctrl = true});
  driver.settle();
  CHECK(points_of(driver, "s1") == pulled);
  CHECK(points_of(driver, "s2") == followed);
  ReplayOptions every_line;
  every_line.from_checkpoint = false;
  const auto played = read_case(driver.case_file(), every_line);
  REQUIRE_MESSAGE(played, played.error().sentence());
  CHECK(*played->session.document().view("s1")->shape.points == pulled);
  CHECK(*played->session.document().view("s2")->shape.points == followed);

  // Once more, with neighbours kept apart: what is shared is not.
  driver.app().send(KeepApartAfterStrokes{true});
  driver.settle();
  pull_vertex_0(driver);
  CHECK(shared_apart_mm(driver) < 1e-6);
}

TEST_CASE("a locked structure keeps what it shares, and the one that is pulled goes back to it there") {
  Driver driver(demo());
  start_with_shared(driver);
  driver.app().send(LockStructures{{"s2"}, true});
  driver.settle();
  const Points first = points_of(driver, "s1"), second = points_of(driver, "s2");
  pull_vertex_0(driver);
  CHECK(points_of(driver, "s2") == second);
  CHECK((points_of(driver, "s1") - first).rowwise().norm().maxCoeff() > 0.5);
  CHECK(shared_apart_mm(driver) < 2e-5);  // on the grid of computed points
}

TEST_CASE("a structure that undo takes away is worked on no more") {
  Driver driver(demo());
  start_with_two(driver);
  driver.app().send(ChooseStructure{"s2"});
  driver.settle();
  driver.app().send(ApplyEdit{Undo{}});
  driver.settle();
  CHECK(driver.document().structures.size() == 1);
  CHECK(driver.state().look.structure.empty());
  driver.app().send(ChooseStructure{"s2"});
  driver.settle();
  CHECK(driver.shows("There is no structure \"s2\" in this case."));
}

TEST_CASE("a click on another outline works on that structure and moves nothing") {
  Driver driver(demo());
  start_with_two(driver);
  const Points first = points_of(driver, "s1"), second = points_of(driver, "s2");
  const auto [x, y] = on_axial_outline(driver, "s2");
  const Vec3 looked_at = driver.state().look.crosshair_mm;
  driver.move(x, y);
  driver.frame();
  CHECK(driver.state().pointer.hover->structure == "s2");
  CHECK(driver.shows("Click to work on \"small kidney\"."));
  driver.button(MouseButton::left, true);
  driver.button(MouseButton::left, false);
  driver.settle();
  CHECK(driver.state().look.structure == "s2");
  CHECK(driver.state().pointer.hover->structure.empty());
  CHECK(driver.state().look.crosshair_mm == looked_at);
  CHECK(points_of(driver, "s1") == first);
  CHECK(points_of(driver, "s2") == second);
  CHECK_FALSE(driver.app().snapshot().undo_names.front().starts_with("pull"));
}

TEST_CASE("a row of the list works on its structure and its eye and lock are of all that are chosen") {
  Driver driver(demo());
  start_with_two(driver);
  const StructureLooks& looks = driver.state().look.structures;
  driver.click("small kidney/small kidney");
  driver.settle();
  CHECK(driver.state().look.structure == "s2");
  const Points second = points_of(driver, "s2");
  CHECK(bounds_of(second).contains(driver.state().look.crosshair_mm));

  driver.click("small kidney/eye");
  CHECK(looks.hidden == std::set<std::string>{"s2"});
  const auto [x, y] = on_axial_outline(driver, "s2");
  driver.move(x, y);
  driver.frame();
  CHECK_FALSE(driver.state().pointer.hover->on_mesh);
  driver.hold_keys({.ctrl = true});
  driver.click("kidney/kidney");
  driver.hold_keys({});
  CHECK(looks.chosen == std::set<std::string>{"s1", "s2"});
  CHECK(driver.state().look.structure == "s2");
  driver.click("small kidney/eye");
  CHECK(looks.hidden.empty());
  driver.click("small kidney/lock");
  CHECK(looks.locked == std::set<std::string>{"s1", "s2"});
  driver.click("Only this");
  CHECK(looks.hidden.empty());
  driver.click("small kidney/small kidney");
  driver.click("Only this");
  CHECK(looks.hidden == std::set<std::string>{"s1"});
  driver.click("Show none");
  CHECK(looks.hidden.size() == 2);
  driver.click("Show all");
  CHECK(looks.hidden.empty());
}

TEST_CASE("a locked structure refuses edits with a sentence and the others take them") {
  Driver driver(demo());
  start_with_two(driver);
  driver.click("small kidney/small kidney");
  driver.click("small kidney/lock");
  const Points second = points_of(driver, "s2");
  const auto [x, y] = on_axial_outline(driver, "s2");
  driver.move(x, y);
  driver.button(MouseButton::left, true);
  driver.move(x + 12, y + 4);
  driver.frame();
  driver.button(MouseButton::left, false);
  driver.settle();
  CHECK(driver.shows("\"small kidney\" is locked."));
  driver.app().send(ApplyEdit{SetStiffnessBase{7}});
  driver.settle();
  CHECK(points_of(driver, "s2") == second);
  CHECK(driver.document().structure("s2")->paint.base == 3);
  driver.press('E');
  driver.settle();
  CHECK(driver.state().look.structure.empty());
  driver.app().send(ApplyEdit{SetStiffnessBase{7}});
  driver.settle();
  CHECK(driver.document().structure("s1")->paint.base == 7);
}

TEST_CASE("the list has the worst first and shows what the filter says, and two keys go through it") {
  Driver driver(demo());
  start_with_two(driver);
  driver.app().send(ApplyEdit{SetStructure{.id = "s1", .name = "left kidney", .confidence = 0.9}});
  driver.app().send(ApplyEdit{SetStructure{.id = "s2", .confidence = 0.2, .doubt = "It is too small."}});
  driver.wait_until("both are judged", [&] { return driver.document().structure("s2")->confidence == 0.2; });
  driver.settle();
  const auto row_y = [&](const char* name) { return driver.control(name).rect.y; };
  CHECK(row_y("small kidney/small kidney") < row_y("left kidney/left kidney"));
  driver.click("Worst first");
  CHECK(row_y("small kidney/small kidney") > row_y("left kidney/left kidney"));
  CHECK(driver.shows("20 %"));
  driver.press('W');
  driver.settle();
  CHECK(driver.state().look.structure == "s2");
  driver.press('E');
  driver.settle();
  CHECK(driver.state().look.structure.empty());
  driver.type_into("filter", "SMALL");
  driver.settle();
  CHECK_FALSE(driver.has("left kidney/left kidney"));
  CHECK(driver.has("small kidney/small kidney"));
}

TEST_CASE("rows chosen with Shift are all between and Ctrl takes one away") {
  Driver driver(demo());
  Document document = driver.document();
  for (const char* id : {"s2", "s3", "s4"}) {
    Structure one = *document.structure();
    one.id = one.name = id;
    document.structures.push_back(std::make_shared<const Structure>(one));
  }
  StructureLooks looks;
  looks.worst_first = false;
  choose_rows(looks, document, "s2", false, false);
  choose_rows(looks, document, "s4", false, true);
  CHECK(looks.chosen == std::set<std::string>{"s2", "s3", "s4"});
  choose_rows(looks, document, "s3", true, false);
  CHECK(looks.chosen == std::set<std::string>{"s2", "s4"});
  choose_rows(looks, document, "s1", false, true);
  CHECK(looks.chosen == std::set<std::string>{"s1", "s2", "s3"});
  CHECK(rows_with(looks, "s4") == std::vector<std::string>{"s4"});
  CHECK(rows_with(looks, "s1").size() == 3);
}

TEST_CASE("all structures are written as one label map and as meshes of their names") {
  Driver driver(demo());
  start_with_two(driver);
  driver.app().send(ApplyEdit{SetStructure{.id = "s1", .name = "kidney", .colour = {{10, 20, 30}}}});
  driver.settle();
  const auto map = driver.folder() / "all.seg.nrrd", meshes = driver.folder() / "meshes";
  driver.app().send(ExportStructuresMap{{map}});
  driver.app().send(ExportStructuresMeshes{{meshes}});
  driver.wait_until("both are written", [&] { return std::filesystem::exists(meshes / "small kidney.ply"); });
  driver.settle();
  const auto read = read_labels(map);
  REQUIRE(read);
  REQUIRE(read->segmentation.segments.size() == 2);
  CHECK(read->segmentation.segments[0].name == "kidney");
  CHECK(read->segmentation.segments[0].colour == std::array<std::uint8_t, 3>{10, 20, 30});
  CHECK(read->segmentation.segments[1].name == "small kidney");
  const Points points = points_of(driver, "s2");
  const auto mesh = read_mesh_file(meshes / "small kidney.ply");
  REQUIRE(mesh);
  CHECK((mesh->points - points).cwiseAbs().maxCoeff() < 1e-3);
  CHECK(std::filesystem::exists(meshes / "kidney.ply"));
}

TEST_CASE("a person's word ends a doubt and leads to the next doubtful structure") {
  Driver driver(demo());
  start_with_two(driver);
  for (const char* id : {"s1", "s2"})
    driver.app().send(ApplyEdit{SetStructure{.id = id, .confidence = 0.2, .doubt = "It is too small."}});
  driver.settle();
  driver.click("It is right");
  driver.settle();
  CHECK(driver.document().structure("s1")->confidence == 1);
  CHECK(driver.document().structure("s1")->doubt.empty());
  CHECK(driver.state().look.structure == "s2");
  driver.click("It is right");
  driver.settle();
  CHECK_FALSE(is_doubtful(*driver.document().structure("s2")));
  driver.press('K');
  driver.settle();
  CHECK(driver.shows("No other structure is doubtful."));
  driver.press('Z', {.ctrl = true});
  driver.settle();
  CHECK(is_doubtful(*driver.document().structure("s2")));
}

TEST_CASE("a level and all below get other names in one step and none is given twice") {
  Driver driver(demo());
  start_with_two(driver);
  driver.app().send(ApplyEdit{SetStructure{.id = "s1", .name = "vertebrae_L1"}});
  driver.app().send(ApplyEdit{SetStructure{.id = "s2", .name = "disc_L1_L2"}});
  driver.settle();
  driver.click("One level up");
  driver.settle();
  CHECK(driver.document().structure("s1")->name == "vertebrae_T12");
  CHECK(driver.document().structure("s2")->name == "disc_T12_L1");
  driver.press('Z', {.ctrl = true});
  driver.settle();
  CHECK(driver.document().structure("s1")->name == "vertebrae_L1");
  CHECK(driver.document().structure("s2")->name == "disc_L1_L2");
  driver.app().send(ApplyEdit{SetStructure{.id = "s2", .name = "vertebrae_L2"}});
  driver.app().send(ChooseStructure{"s2"});
  driver.settle();
  driver.click("One level up");
  driver.settle();
  CHECK(driver.shows("\"vertebrae_L1\" is there already"));
  CHECK(driver.document().structure("s2")->name == "vertebrae_L2");
}

TEST_CASE("the keys that go through the structures bring the row into sight and the name into the status line") {
  Driver driver(demo(), {1280, 1600, 1});
  const SetStructure one = small_kidney(driver.document());
  constexpr int structures = 20;
  for (int k = 2; k <= structures; ++k) {
    SetStructure next = one;
    next.id = "s" + std::to_string(k);
    next.name = "kidney " + std::to_string(k);
    driver.app().send(ApplyEdit{std::move(next)});
  }
  driver.wait_until("all are there", [&] { return driver.document().structures.size() == structures; });
  driver.settle();
  const auto in_sight = [&](const std::string& name) {
    const RectPx seen = driver.control(name + "/" + name).seen;
    return seen.width > 0 && seen.height > 0;
  };
  driver.point_at("kidney 2/kidney 2");
  CHECK_FALSE(in_sight("kidney 20"));
  driver.press('W');  // from the first one back to the last
  driver.settle();
  REQUIRE(driver.state().look.structure == "s20");
  CHECK(in_sight("kidney 20"));
  CHECK(driver.shows("kidney 20: "));
  driver.press('E');
  driver.press('E');
  driver.settle();
  REQUIRE(driver.state().look.structure == "s2");
  CHECK(in_sight("kidney 2"));
  CHECK(driver.shows("kidney 2: "));

  // What the last edit said is no news of another structure.
  driver.app().send(ApplyEdit{SetStiffnessBase{7}});
  driver.settle();
  driver.press('Z', {.ctrl = true});
  driver.settle();
  CHECK(driver.shows("Undone: stiffness."));
  driver.press('E');
  driver.settle();
  CHECK_FALSE(driver.shows("Undone: stiffness."));
  CHECK(driver.shows("kidney 3: "));
}

}  // namespace homolog
