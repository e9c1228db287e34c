#include "app/editor/state/views.h"
#include "tests/changed_shape.h"
#include "tests/desk.h"

namespace homolog {

TEST_CASE("dragging the outline previews a stroke and commits it once when let go") {
  Desk desk;
  const Eigen::Vector2d at = desk.on_outline(ViewKind::axial);
  desk.send(MousePress{}, at.x(), at.y());
  desk.send(MouseMove{}, at.x() - 10, at.y());
  const auto previews = desk.sent<PreviewEdit>();
  REQUIRE(previews.size() == 1);
  const auto& shown = std::get<Stroke>(*previews[0].action);
  desk.send(MouseRelease{}, at.x() - 10, at.y());
  const auto applied = desk.sent<ApplyEdit>();
  REQUIRE(applied.size() == 1);
  const auto& stroke = std::get<Stroke>(applied[0].action);
  CHECK(stroke == shown);
  CHECK(stroke.tool == Tool::pull);
  CHECK(stroke.sigma_mm == desk.state.hand.sigma_mm());
  const double mm_per_px = desk.state.look.slices[index_of(ViewKind::axial)].mm_per_px;
  CHECK((stroke.to - stroke.at - Vec3(-10 * mm_per_px, 0, 0)).norm() < 1e-9);
}

TEST_CASE("a press without a movement edits nothing") {
  Desk desk;
  const Eigen::Vector2d at = desk.on_outline(ViewKind::coronal);
  desk.send(MousePress{}, at.x(), at.y());
  desk.send(MouseRelease{}, at.x(), at.y());
  CHECK(desk.sent<ApplyEdit>().empty());
  CHECK_FALSE(desk.state.pointer.drag);
}

TEST_CASE("Escape takes a drag back") {
  Desk desk;
  const Eigen::Vector2d at = desk.on_outline(ViewKind::axial);
  desk.send(MousePress{}, at.x(), at.y());
  desk.send(MouseMove{}, at.x() - 10, at.y());
  desk.out.take();
  desk.press(key::escape);
  const auto previews = desk.sent<PreviewEdit>();
  REQUIRE(previews.size() == 1);
  CHECK_FALSE(previews[0].action);
  desk.send(MouseRelease{}, at.x() - 10, at.y());
  CHECK(desk.sent<ApplyEdit>().empty());
}

TEST_CASE("the wheel changes the reach during a drag and the slice otherwise") {
  Desk desk;
  const Eigen::Vector2d at = desk.on_outline(ViewKind::axial);
  const Vec3 before = desk.state.look.crosshair_mm;
  desk.send(MousePress{}, at.x(), at.y());
  desk.send(MouseMove{}, at.x() - 10, at.y());
  const double sigma_mm = desk.state.hand.sigma_mm();
  const auto presets_mm = desk.state.hand.sigma_presets_mm;
  desk.send(Wheel{1}, at.x() - 10, at.y());
  CHECK(desk.state.hand.sigma_mm() > sigma_mm);
  CHECK(desk.state.hand.sigma_presets_mm == presets_mm);
  CHECK(desk.state.look.crosshair_mm == before);
  desk.send(MouseRelease{}, at.x() - 10, at.y());
  CHECK(std::get<Stroke>(desk.sent<ApplyEdit>().at(0).action).sigma_mm == desk.state.hand.sigma_mm());
  desk.send(Wheel{1}, at.x(), at.y());
  CHECK(desk.state.look.crosshair_mm.z() - before.z() == doctest::Approx(1.5));
  // A preset comes back as it was, until it is changed on purpose.
  desk.press('2');
  CHECK(desk.state.hand.sigma_mm() == sigma_mm);
  desk.give(SetSigma{7});
  CHECK(desk.state.hand.sigma_presets_mm[1] == 7);
}

TEST_CASE("scrolling stops at the ends of the image") {
  Desk desk;
  const Eigen::Vector2d at = desk.middle_of(ViewKind::axial);
  for (int i = 0; i < 300; ++i) desk.send(Wheel{1}, at.x(), at.y());
  const VolumeGeometry& geometry = desk.document.scan.image->geometry;
  CHECK(desk.state.look.crosshair_mm.z() ==
        doctest::Approx(geometry.bounds_mm().max().z() - geometry.spacing_mm.z() / 2));  // the last slice's middle
  for (int i = 0; i < 300; ++i) desk.send(Wheel{-1}, at.x(), at.y());
  CHECK(desk.state.look.crosshair_mm.z() ==
        doctest::Approx(geometry.bounds_mm().min().z() + geometry.spacing_mm.z() / 2));
}

TEST_CASE("slices are those that were acquired and no mean of two") {
  Desk desk;
  const auto on_voxel = [&] {
    const Vec3 voxel = desk.document.scan.image->geometry.to_voxel(desk.state.look.crosshair_mm);
    return (voxel - Vec3(voxel.array().round().matrix())).norm() < 1e-6;
  };
  CHECK(on_voxel());
  desk.send(MouseMove{}, 290, 200);
  desk.send(MouseMove{}, 301, 207, true);
  CHECK(on_voxel());
  const Vec3 before = desk.state.look.crosshair_mm;
  for (int i = 0; i < 3; ++i) desk.send(Wheel{0.3}, 301, 207);
  CHECK(desk.state.look.crosshair_mm == before);  // a touchpad's parts of a step add up
  desk.send(Wheel{0.3}, 301, 207);
  CHECK((desk.state.look.crosshair_mm - before).norm() == doctest::Approx(1.5));
  CHECK(on_voxel());
}

TEST_CASE("the touches of one brush stroke are one step and the next stroke is another") {
  Desk desk;
  desk.state.hand.tool = MouseTool::stiffness;
  desk.state.hand.brush.radius_mm = 2;
  const Eigen::Vector2d at = desk.on_outline(ViewKind::axial);
  for (int stroke = 0; stroke < 2; ++stroke) {
    desk.send(MousePress{}, at.x(), at.y());
    for (int step = 1; step < 12; ++step) desk.send(MouseMove{}, at.x(), at.y() - 2 * step);
    desk.send(MouseRelease{}, at.x(), at.y() - 24);
    const auto touches = desk.sent<ApplyEdit>();
    REQUIRE(touches.size() > 1);
    for (std::size_t i = 0; i < touches.size(); ++i) CHECK(touches[i].joined == (i > 0));
  }
}

TEST_CASE("a brush that begins beside the outline paints what its circle covers") {
  for (const MouseTool tool : {MouseTool::stiffness, MouseTool::confirm}) {
    Desk desk;
    desk.state.hand.tool = tool;
    desk.state.hand.brush.radius_mm = 10;
    const Eigen::Vector2d on_outline = desk.on_outline(ViewKind::axial);
    const ViewMap map = view_map(desk.state, desk.layout, desk.document, ViewKind::axial);
    const double mm = 1 / map.mm_per_px(desk.state.look.crosshair_mm);
    desk.send(MousePress{}, on_outline.x() - 6 * mm, on_outline.y());
    desk.send(MouseRelease{}, on_outline.x() - 6 * mm, on_outline.y());
    const auto dabs = desk.sent<ApplyEdit>();
    REQUIRE(dabs.size() == 1);
    const Action& action = dabs.front().action;
    const Vec3 at = tool == MouseTool::confirm ? std::get<Confirm>(action).at : std::get<PaintStiffness>(action).at;
    const Vec3 pointer = map.on_facing_plane(on_outline.x() - 6 * mm, on_outline.y(), desk.state.look.crosshair_mm);
    CHECK((at - pointer).norm() < 0.01);

    // A stroke that begins farther away paints as soon as its circle comes to the mesh.
    desk.send(MousePress{}, on_outline.x() - 20 * mm, on_outline.y());
    CHECK(desk.sent<ApplyEdit>().empty());
    desk.send(MouseMove{}, on_outline.x(), on_outline.y());
    desk.send(MouseRelease{}, on_outline.x(), on_outline.y());
    const auto later = desk.sent<ApplyEdit>();
    REQUIRE(!later.empty());
    CHECK_FALSE(later.front().joined);
  }
}

TEST_CASE("the dabs of a stroke do not depend on how many events tell of it") {
  const auto dabs = [](double x_px, double y_px, int events, double bend_px) {
    Desk desk;
    desk.state.hand.tool = MouseTool::confirm;
    desk.state.hand.brush.radius_mm = 12;
    const Eigen::Vector2d at = desk.on_outline(ViewKind::axial);
    desk.send(MousePress{}, at.x(), at.y());
    for (int k = 1; k <= events; ++k) {
      const double t = static_cast<double>(k) / events;
      desk.send(MouseMove{}, at.x() + t * x_px, at.y() + t * y_px + bend_px * std::sin(3.14159265358979 * t));
    }
    std::vector<Vec3> places;
    for (const ApplyEdit& dab : desk.sent<ApplyEdit>()) places.push_back(std::get<Confirm>(dab.action).at);
    return places;
  };
  const auto few = dabs(64, 32, 60, 0), many = dabs(64, 32, 1000, 0);
  REQUIRE(few.size() > 3);
  CHECK(bool(few == many));
  const auto few_bent = dabs(60, 0, 60, 20), many_bent = dabs(60, 0, 1000, 20);
  REQUIRE(few_bent.size() == many_bent.size());
  for (std::size_t k = 0; k < few_bent.size(); ++k) CHECK((few_bent[k] - many_bent[k]).norm() < 0.01);
}

TEST_CASE("without a region to paint the brush says so and with one it paints the first") {
  Desk desk;
  desk.state.hand.tool = MouseTool::stiffness;
  desk.state.hand.brush.paints = BrushPaints::region;
  desk.document.change({}, [&](Structure& first) { first.paint.regions = std::make_shared<const Regions>(); });
  const Eigen::Vector2d at = desk.on_outline(ViewKind::axial);
  const auto dab = [&] {
    desk.send(MousePress{}, at.x(), at.y());
    desk.send(MouseRelease{}, at.x(), at.y());
    return desk.sent<ApplyEdit>();
  };
  CHECK(dab().empty());
  REQUIRE(desk.state.notices.size() == 1);
  CHECK(desk.state.notices.front().text.find("Add one first") != std::string::npos);
  auto regions = std::make_shared<Regions>(*desk.document.structure()->paint.regions);
  regions->list.push_back({"hilum", 2, {255, 0, 0}});
  desk.document.change({}, [&](Structure& first) { first.paint.regions = regions; });
  const auto painted = dab();
  REQUIRE(painted.size() == 1);
  CHECK(std::get<PaintRegion>(painted.front().action).name == "hilum");
}

TEST_CASE("Ctrl with the wheel keeps the point under the pointer") {
  Desk desk;
  const auto under = [&] {
    return view_map(desk.state, desk.layout, desk.document, ViewKind::sagittal)
        .on_facing_plane(650, 200, desk.state.look.crosshair_mm);
  };
  const Vec3 before = under();
  desk.send(Wheel{3}, 650, 200, false, true);
  CHECK((under() - before).norm() < 1e-9);
  CHECK(desk.state.look.crosshair_mm == Desk().state.look.crosshair_mm);
}

TEST_CASE("Shift with the mouse moves the cross-hair") {
  Desk desk;
  desk.send(MouseMove{}, 290, 200);
  desk.send(MouseMove{}, 300, 200, true);
  const Vec3 moved = desk.state.look.crosshair_mm;
  const Vec3 from_pointer = moved - *desk.state.pointer.hover->p_mm;  // at most to the middle of the voxel
  CHECK(from_pointer.cwiseAbs().maxCoeff() <= desk.document.scan.image->geometry.spacing_mm.maxCoeff() / 2 + 1e-9);
  desk.send(Wheel{1}, 300, 200);
  const Vec3 scrolled = desk.state.look.crosshair_mm;
  desk.send(MouseMove{}, 300, 200, true);
  CHECK(desk.state.look.crosshair_mm == scrolled);
}

TEST_CASE("a right drag changes the grey window and keeps its centre when it goes sideways") {
  Desk desk;
  const double centre = (desk.state.look.window_low + desk.state.look.window_high) / 2;
  const double width = desk.state.look.window_high - desk.state.look.window_low;
  desk.send(MousePress{MouseButton::right}, 300, 200);
  desk.send(MouseMove{}, 400, 200);
  desk.send(MouseRelease{MouseButton::right}, 400, 200);
  CHECK((desk.state.look.window_low + desk.state.look.window_high) / 2 == doctest::Approx(centre));
  CHECK(desk.state.look.window_high - desk.state.look.window_low > width);
}

TEST_CASE("keys choose tools and reaches and ask for undo") {
  Desk desk;
  desk.press('G');
  CHECK(desk.state.hand.tool == MouseTool::grab);
  desk.press('1');
  CHECK(desk.state.hand.sigma_mm() == desk.state.hand.sigma_presets_mm[0]);
  desk.press('Z', true);
  const auto applied = desk.sent<ApplyEdit>();
  REQUIRE(applied.size() == 1);
  CHECK(std::holds_alternative<Undo>(applied[0].action));
}

TEST_CASE("a click of the landmark tool places the landmark and goes on to the next") {
  Desk desk;
  desk.press('L');
  const std::string first = desk.state.hand.landmark;
  REQUIRE_FALSE(first.empty());
  const Eigen::Vector2d at = desk.middle_of(ViewKind::sagittal);
  desk.send(MousePress{}, at.x(), at.y());
  desk.send(MouseRelease{}, at.x(), at.y());
  const auto applied = desk.sent<ApplyEdit>();
  REQUIRE(applied.size() == 1);
  const auto& placed = std::get<PlaceLandmark>(applied[0].action);
  CHECK(placed.name == first);
  CHECK(desk.state.hand.landmark != first);
}

TEST_CASE("a click on a placed landmark leaves it and a drag keeps its distance from the pointer") {
  Desk desk;
  desk.state.hand.tool = MouseTool::landmark;
  const Eigen::Vector2d at = desk.middle_of(ViewKind::sagittal);
  update_hover(desk.state, desk.context(), at.x(), at.y());
  const Vec3 place = *desk.state.pointer.hover->p_mm + Vec3(0.5, 1, 1);
  test::changed_shape(desk.document).landmarks["hilum"] = place;
  desk.send(MousePress{}, at.x(), at.y());
  desk.send(MouseRelease{}, at.x(), at.y());
  CHECK(desk.sent<ApplyEdit>().empty());
  desk.send(MousePress{}, at.x(), at.y());
  desk.send(MouseMove{}, at.x() + 10, at.y());
  desk.send(MouseRelease{}, at.x() + 10, at.y());
  const auto applied = desk.sent<ApplyEdit>();
  REQUIRE(applied.size() == 1);
  const auto& moved = std::get<PlaceLandmark>(applied[0].action);
  CHECK(moved.name == "hilum");
  const double mm_per_px = desk.state.look.slices[index_of(ViewKind::sagittal)].mm_per_px;
  CHECK((*moved.at - place - Vec3(0, 10 * mm_per_px, 0)).norm() < 1e-9);
}

TEST_CASE("only the button that started a drag ends it") {
  Desk desk;
  const Eigen::Vector2d at = desk.on_outline(ViewKind::axial);
  desk.send(MousePress{}, at.x(), at.y());
  desk.send(MouseMove{}, at.x() - 10, at.y());
  desk.send(MouseRelease{MouseButton::middle}, at.x() - 10, at.y());
  CHECK(desk.state.pointer.drag);
  CHECK(desk.sent<ApplyEdit>().empty());
  desk.send(MouseRelease{}, at.x() - 10, at.y());
  CHECK(desk.sent<ApplyEdit>().size() == 1);
}

TEST_CASE("the reach chosen between press and release edits nothing by itself") {
  Desk desk;
  const Eigen::Vector2d at = desk.on_outline(ViewKind::axial);
  desk.send(MousePress{}, at.x(), at.y());
  desk.send(KeyPress{'1'}, at.x(), at.y());
  desk.send(MouseMove{}, at.x(), at.y());  // the key let go
  desk.send(MouseRelease{}, at.x(), at.y());
  CHECK(desk.sent<ApplyEdit>().empty());
}

TEST_CASE("an edit of a playing cine stops it first") {
  Desk desk;
  const Eigen::Vector2d at = desk.on_outline(ViewKind::axial);
  desk.state.look.playing = true;
  desk.send(MousePress{}, at.x(), at.y());
  const auto asked = desk.sent<PlayFrames>();
  REQUIRE(asked.size() == 1);
  CHECK_FALSE(asked[0].play);
}

TEST_CASE("the ruler in the 3D view measures between points of the surface") {
  Desk desk;
  desk.state.preferences.show.planes = false;
  desk.state.hand.tool = MouseTool::ruler;
  const Eigen::Vector2d at = desk.middle_of(ViewKind::space);
  desk.send(MouseMove{}, at.x(), at.y());
  const Vec3 from = *desk.state.pointer.hover->on_mesh;
  desk.send(MousePress{}, at.x(), at.y());
  desk.send(MouseMove{}, at.x() - 20, at.y() - 20);
  REQUIRE(desk.state.hand.ruler);
  CHECK(desk.state.hand.ruler->from == from);
  CHECK(desk.state.hand.ruler->to == *desk.state.pointer.hover->on_mesh);
}

TEST_CASE("the knob of the placement follows the pointer in any slice") {
  Desk desk;
  const ViewMap map = view_map(desk.state, desk.layout, desk.document, ViewKind::axial);
  PlaceDrag drag;
  drag.part = PlacePart::knob;
  drag.centre_mm = desk.state.look.crosshair_mm + 30 * map.into_screen();
  const Eigen::Vector2d centre = *map.to_px(drag.centre_mm);
  drag.press_mm = map.on_facing_plane(centre.x() + 40, centre.y(), drag.centre_mm);
  CHECK(dragged_placement(drag, map, centre.x() + 80, centre.y()).scale == doctest::Approx(2));
}

TEST_CASE("scrolling in oblique planes stops at the image's end and comes back where it was") {
  Desk desk;
  auto volume = std::make_shared<Volume>(*desk.document.scan.image);
  VolumeGeometry& geometry = volume->geometry;
  geometry.direction = Eigen::AngleAxisd(0.4, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  desk.document.scan.image = volume;
  desk.state.look.own_planes = true;
  desk.state.look.crosshair_mm = geometry.bounds_mm().center() + Vec3(3, 4, 5);
  settle_crosshair(desk.state, desk.document);
  const Vec3 before = desk.state.look.crosshair_mm;
  const Vec3 normal = slice_view(desk.state, ViewKind::axial, geometry).normal();
  scroll_slice(desk.state, ViewKind::axial, desk.document, 500);
  CHECK((desk.state.look.crosshair_mm - before).cross(normal).norm() < 1e-9);
  CHECK((desk.state.look.crosshair_mm - before).norm() < geometry.bounds_mm().diagonal().norm());
}

}  // namespace homolog
