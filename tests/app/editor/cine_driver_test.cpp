#include <doctest/doctest.h>

#include <map>

#include "app/editor/update/status.h"
#include "core/base/files/files.h"
#include "tests/beating_ball.h"
#include "tests/driver.h"
#include "tests/must.h"

// A cine as a person works on it: propagate, look at the curve, correct a frame, propagate again, undo.

namespace homolog {

namespace {

bool all_frames_have_volumes(Driver& driver) {
  return driver.state().found.volume_curve.frames.size() == BeatingBall::frames;
}

/// Clicks on the volume curve at a frame.
void click_curve(Driver& driver, int frame) {
  driver.point_at("Cine/volume curve");
  const DrawnItem curve = driver.control("Cine/volume curve");
  const double left = curve.rect.x + 32, right = curve.rect.x + curve.rect.width - 2;
  driver.move(left + (right - left) * (frame + 0.5) / BeatingBall::frames, curve.rect.y + curve.rect.height / 2);
  driver.frame();
  driver.button(MouseButton::left, true);
  driver.frame();
  driver.button(MouseButton::left, false);
  driver.settle();
}

}  // namespace

TEST_CASE("a cine is propagated and corrected and propagated again in the window") {
  Driver driver(BeatingBall::document(), {1280, 1400, 1});
  CHECK(driver.shows("End systole"));
  CHECK(driver.shows("not known"));
  CHECK(driver.shows("From frame 0."));
  driver.click("Cine/Propagate");
  driver.wait_until("every frame has a mesh", [&] { return all_frames_have_volumes(driver); });
  driver.settle();
  CHECK(driver.lines_with("\"of_frame\"") == BeatingBall::frames);
  CHECK(driver.shows("Carried through 5 frames; none is in doubt."));
  CHECK(driver.document().frame == 0);
  REQUIRE(driver.state().found.volume_curve.ejection);
  CHECK(driver.state().found.volume_curve.ejection->end_systole == 3);
  driver.point_at("Cine/Next in doubt");
  CHECK(driver.shows("Ejection fraction"));
  CHECK(driver.shows("frame 3"));

  click_curve(driver, 2);
  CHECK(driver.document().frame == 2);
  const Points carried = *driver.document().view()->shape.points;
  Stroke pull;
  pull.at = carried.row(0);
  pull.to = 1.15 * pull.at;
  pull.sigma_mm = 12;
  driver.app().send(ApplyEdit{pull});
  driver.wait_until("the frame is a known one", [&] { return driver.shows("From frames 0 and 2."); });
  const Points corrected = *driver.document().view()->shape.points;
  const Points before = *driver.document().structure()->shape(1)->points;
  driver.click("Cine/Propagate");
  driver.wait_until("the frames between follow it", [&] {
    return *driver.document().structure()->shape(1)->points != before &&
           driver.document().structure()->shapes.size() == 6;
  });
  driver.settle();
  CHECK(*driver.document().structure()->shape(2)->points == corrected);

  driver.press('Z', {false, true, false});
  driver.wait_until("one step back", [&] { return *driver.document().structure()->shape(1)->points == before; });
  CHECK(*driver.document().structure()->shape(2)->points == corrected);
}

TEST_CASE("all structures that are not locked go through a cine, as one step to undo, and their wall is measured") {
  Document document = BeatingBall::document();
  for (const auto& [id, by] : {std::pair("s2", 1.25), std::pair("s3", 1.1)}) {
    auto further = std::make_shared<Structure>(*document.structures.front());
    further->id = id;
    further->name = id;
    Shape shape = *further->shape(0);
    shape.points = std::make_shared<const Points>(*shape.points * by);
    further->set_shape(0, std::move(shape));
    document.structures.push_back(std::move(further));
  }
  Driver driver(document, {1280, 1400, 1});
  driver.app().send(LockStructures{{"s3"}, true});
  driver.settle();
  driver.click("Cine/Propagate");
  const auto frames_of = [&](std::size_t k) { return driver.document().structures[k]->shapes.size(); };
  driver.wait_until("both have all frames", [&] { return frames_of(0) == 6 && frames_of(1) == 6; });
  driver.settle();
  CHECK(frames_of(2) == 1);
  CHECK(driver.shows("Wall thickness"));
  CHECK(driver.state().found.volume_curve.outer == "s2");
  CHECK(driver.state().found.volume_curve.frames.at(0).wall->thickness_mm ==
        doctest::Approx(0.25 * BeatingBall::radius_mm(0)).epsilon(0.05));
  driver.press('Z', {false, true, false});
  driver.wait_until("one step back", [&] { return frames_of(0) == 1 && frames_of(1) == 1; });
}

TEST_CASE("a propagation that is cancelled or overtaken by an edit leaves the meshes") {
  Driver driver(BeatingBall::document());
  driver.hurry(true);
  driver.click("Cine/Propagate");
  driver.click("Cine/Cancel");
  driver.settle();
  CHECK(driver.lines_with("\"of_frame\"") == 0);
  CHECK(driver.has("Cine/Propagate"));
}

TEST_CASE("a frame without a mesh says where one comes from and not that a template is wanted") {
  Driver driver(BeatingBall::document(), {1280, 1400, 1});
  driver.click("side panel/Place");
  driver.app().send(SeekFrame{3});  // as while the slider is dragged
  driver.frames(3);
  CHECK_FALSE(driver.shows("Load a template first"));
  std::size_t said = 0;  // in Place, in Correspondence and at the window's foot
  for (const DrawnItem& item : driver.items())
    said += item.name == "This frame has no mesh yet. Start from previous (Cine) copies one.";
  CHECK(said == 3);
  driver.type_into("Cine/Frame/value", "2");
  driver.press(key::enter);
  driver.settle();
  CHECK(driver.document().frame == 2);  // a frame that is typed is the case's
  driver.type_into("Cine/Frame/value", "4");
  driver.press(key::enter);
  driver.settle();
  CHECK(driver.document().frame == 4);  // and so where no other was looked at before
  Document late = BeatingBall::document();
  late.change({}, [](Structure& first) {
    first.shapes[4] = first.shapes.at(0);
    first.shapes.erase(0);
  });
  CHECK(why_no_mesh(driver.state(), late) ==
        "This frame has no mesh yet. Go to a frame that has one, and propagate it (Cine).");
}

TEST_CASE("a template that is chosen at a frame of a cine is placed in that frame") {
  Driver driver(BeatingBall::document(), {1280, 1400, 1});
  driver.type_into("Cine/Frame/value", "2");
  driver.press(key::enter);
  driver.settle();
  driver.click("Template/Ventricle");
  driver.wait_until("the template is open",
                    [&] { return driver.document().structure()->the_template->source == "built-in:ventricle"; });
  driver.settle();
  CHECK(driver.document().frame == 2);
  CHECK(driver.document().view());
  CHECK(driver.control("Cine/Frame/value").value == "2");
  CHECK(driver.shows("From frame 2."));
}

TEST_CASE("why a frame is in doubt is said where a person sees it also where the panel ends before it") {
  Document document = BeatingBall::document();
  EditSession session(document);
  for (const int frame : {1, 2, 3, 4}) {
    SetPoints carried =
        points_edit(*session.document().view(), frame, *document.view()->shape.points, FoundBy::propagation);
    if (frame == 3) carried.doubt = "does not show the boundary; its mesh is taken from the frames around it";
    REQUIRE(session.apply(carried));
  }
  Driver driver(session.document(), {800, 600, 1});
  driver.click("Cine/Next in doubt");
  driver.settle();
  REQUIRE(driver.document().frame == 3);
  const std::string reason = "Frame 3 does not show the boundary; its mesh is taken from the frames around it.";
  std::size_t hidden = 0, whole = 0;
  for (const DrawnItem& item : driver.items()) {
    if (item.name.find(reason) == std::string::npos) continue;
    ++(item.seen.height >= item.rect.height && item.seen.width >= item.rect.width ? whole : hidden);
  }
  CHECK(hidden + whole == 2);  // the panel, which may end before it, and the status
  CHECK(whole >= 1);
}

TEST_CASE("a cine that starts from a template that lacks a part of its label is in doubt and the panel says why") {
  Document document = BeatingBall::document();
  MeshFile file = to_mesh_file(*document.structure()->the_template);
  file.comments.push_back(missing_share_comment(0.21));
  document.change(
      {}, [&](Structure& first) { first.the_template = test::must(make_template(std::move(file), "ball.ply")); });
  Driver driver(std::move(document), {1280, 1400, 1});
  const char* const why = "comes from a template that lacks 21 % of the label that it was made of";
  driver.point_at("Cine/Propagate");
  CHECK(driver.shows(why));
  driver.click("Cine/Propagate");
  driver.wait_until("every frame has a mesh", [&] { return all_frames_have_volumes(driver); });
  driver.settle();
  CHECK(driver.shows("6 of 6"));
  CHECK_FALSE(driver.state().found.volume_curve.ejection);
  CHECK(driver.document().structure()->shape(3)->doubt == why);
  // The mesh is corrected: its frame is in no doubt.
  driver.app().send(ApplyEdit{points_edit(*driver.document().view(), 0,
                                          1.06 * *driver.document().structure()->shape(0)->points, FoundBy::fit)});
  driver.wait_until("frame 0 is known", [&] { return driver.shows("5 of 6"); });
}

TEST_CASE("frames in doubt are shown one after the other and volumes are written") {
  Document document = BeatingBall::document();
  EditSession session(document);
  for (const int frame : {1, 2, 3, 4}) {
    SetPoints carried = points_edit(*session.document().view(), frame,
                                    (1 - 0.05 * frame) * *document.view()->shape.points, FoundBy::propagation);
    if (frame % 2 == 0) carried.doubt = "shows less of the boundary than other frames";
    REQUIRE(session.apply(carried));
  }
  Driver driver(session.document(), {1280, 1400, 1});
  driver.point_at("Cine/Next in doubt");
  CHECK(driver.shows("2 of 4"));
  driver.click("Cine/Next in doubt");
  driver.settle();
  CHECK(driver.document().frame == 2);
  CHECK(driver.shows("Frame 2 shows less of the boundary than other frames."));
  driver.click("Cine/Next in doubt");
  driver.settle();
  CHECK(driver.document().frame == 4);
  driver.click("Cine/Volumes…");
  const auto file = driver.folder() / "volumes.csv";
  driver.type_into("name", file.string());
  driver.press(key::enter);
  driver.wait_until("it is said that the file is written", [&] { return driver.shows("Written: " + file.string()); });
  CHECK(test::must(read_whole_file(file)).starts_with("frame,seconds,volume_ml,known,doubt\n1,0.0000,"));
}

TEST_CASE("a cine that plays is propagated from the frame that is shown") {
  Driver driver(BeatingBall::document());
  driver.app().send(ApplyEdit{SetFrame{2}});
  driver.settle();
  driver.app().send(ApplyEdit{StartFrameFrom{0}});
  driver.settle();
  driver.app().send(ApplyEdit{SetFrame{0}});
  driver.settle();
  // As when it plays: the case is at frame 0, and frame 2 is on the screen.
  driver.state().look.playing = true;
  driver.state().look.next_frame_seconds = 1e9;
  driver.state().look.shown_frame = 2;
  driver.frame();
  REQUIRE(driver.app().snapshot().document->frame == 0);
  driver.app().send(PropagateFrames{});
  driver.wait_until("every frame has a mesh",
                    [&] { return driver.document().structure()->shapes.size() == BeatingBall::frames; });
  driver.settle();
  CHECK(driver.document().frame == 2);
  CHECK(driver.lines_with("\"by\":\"start of the cine\",\"of_frame\":2") == 1);
  CHECK(driver.document().structure()->shape(0)->carried != nullptr);
}

TEST_CASE("a cine that is propagated twice without an edit between keeps its meshes") {
  Driver driver(BeatingBall::document(), {1280, 1400, 1});
  const auto propagate = [&] {
    const int before = driver.lines_with("\"by\":\"propagate\"");
    driver.click("Cine/Propagate");
    driver.wait_until("every frame has a mesh",
                      [&] { return !driver.app().busy() && driver.lines_with("\"by\":\"propagate\"") > before; });
    driver.settle();
    std::map<int, Points> meshes;
    for (const auto& [frame, shape] : driver.document().structure()->shapes) meshes.emplace(frame, *shape->points);
    return meshes;
  };
  const auto first = propagate();
  REQUIRE(first.size() == BeatingBall::frames);
  const auto second = propagate();
  REQUIRE(second.size() == first.size());
  for (const auto& [frame, points] : first) CHECK((second.at(frame) - points).cwiseAbs().maxCoeff() < 2e-5);
  CHECK(driver.document().frame == 0);
}

}  // namespace homolog
