#include <set>

#include "app/editor/state/views.h"
#include "app/editor/update/keys.h"
#include "tests/desk.h"

// Which way a wheel, a drag or a key goes, and how far.

namespace homolog {

namespace {

double grey_level(const Desk& desk) {
  return (desk.state.look.window_low + desk.state.look.window_high) / 2;
}
double grey_width(const Desk& desk) {
  return desk.state.look.window_high - desk.state.look.window_low;
}

void drag(Desk& desk, MouseButton button, const Eigen::Vector2d& from, const Eigen::Vector2d& by) {
  desk.send(MousePress{button}, from.x(), from.y());
  desk.send(MouseMove{}, from.x() + by.x(), from.y() + by.y());
  desk.send(MouseRelease{button}, from.x() + by.x(), from.y() + by.y());
}

}  // namespace

TEST_CASE("the wheel turned up comes nearer in slices and in space and scrolls to the head") {
  Desk desk;
  const Eigen::Vector2d slice = desk.middle_of(ViewKind::axial), space = desk.middle_of(ViewKind::space);
  const double mm_per_px = desk.state.look.slices[index_of(ViewKind::axial)].mm_per_px;
  desk.send(MouseMove{}, slice.x(), slice.y());
  desk.send(Wheel{2}, slice.x(), slice.y(), false, true);
  CHECK(desk.state.look.slices[index_of(ViewKind::axial)].mm_per_px == doctest::Approx(mm_per_px / (1.12 * 1.12)));
  const double away_mm = desk.state.look.camera.distance_mm;
  desk.send(MouseMove{}, space.x(), space.y());
  desk.send(Wheel{1}, space.x(), space.y());
  CHECK(desk.state.look.camera.distance_mm == doctest::Approx(away_mm / 1.12));
  desk.send(MouseMove{}, slice.x(), slice.y());
  const double z = desk.state.look.crosshair_mm.z();
  desk.send(Wheel{1}, slice.x(), slice.y());
  CHECK(desk.state.look.crosshair_mm.z() > z);
}

TEST_CASE("the wheel turned up widens a stroke by a tenth") {
  Desk desk;
  const Eigen::Vector2d at = desk.on_outline(ViewKind::axial);
  desk.send(MousePress{}, at.x(), at.y());
  const double sigma_mm = desk.state.hand.sigma_mm();
  desk.send(Wheel{1}, at.x(), at.y());
  CHECK(desk.state.hand.sigma_mm() == doctest::Approx(1.1 * sigma_mm));
  desk.send(Wheel{-2}, at.x(), at.y());
  CHECK(desk.state.hand.sigma_mm() == doctest::Approx(sigma_mm / 1.1));
}

TEST_CASE("a right drag to the right widens the grey window and one upwards brightens") {
  const Eigen::Vector2d from(300, 300);
  Desk wider;
  const double width = grey_width(wider), level = grey_level(wider);
  drag(wider, MouseButton::right, from, {100, 0});
  CHECK(grey_width(wider) == doctest::Approx(width * std::exp(0.5)));
  Desk narrower;
  drag(narrower, MouseButton::right, from, {-100, 0});
  CHECK(grey_width(narrower) == doctest::Approx(width * std::exp(-0.5)));
  Desk brighter;
  drag(brighter, MouseButton::right, from, {0, -60});
  CHECK(grey_level(brighter) == doctest::Approx(level - 0.2 * width));
  CHECK(grey_width(brighter) == doctest::Approx(width));
}

TEST_CASE("a middle drag takes the image along") {
  for (const ViewKind kind : {ViewKind::axial, ViewKind::sagittal, ViewKind::coronal, ViewKind::space}) {
    Desk desk;
    const Eigen::Vector2d from = desk.middle_of(kind), by(30, -20);
    const auto on = [&](const Eigen::Vector2d& px) {
      return view_map(desk.state, desk.layout, desk.document, kind)
          .on_facing_plane(px.x(), px.y(),
                           kind == ViewKind::space ? desk.state.look.camera.target : desk.state.look.crosshair_mm);
    };
    const Vec3 grabbed = on(from);
    drag(desk, MouseButton::middle, from, by);
    const auto now = view_map(desk.state, desk.layout, desk.document, kind).to_px(grabbed);
    REQUIRE(now);
    CHECK((*now - (from + by)).norm() < 0.5);
  }
}

TEST_CASE("a drag in space turns the organ with the pointer") {
  Desk desk;
  desk.state.preferences.show.planes = false;
  desk.state.hand.tool = MouseTool::place;
  const Camera3D before = desk.state.look.camera;
  const Vec3 near = before.target + 20 * before.to_eye;  // on the side of the eye: it goes where the pointer goes
  const auto seen = [&] { return *view_map(desk.state, desk.layout, desk.document, ViewKind::space).to_px(near); };
  const Eigen::Vector2d start = seen();
  drag(desk, MouseButton::right, desk.middle_of(ViewKind::space), {40, 0});
  CHECK(seen().x() > start.x() + 3);
  Desk down;
  drag(down, MouseButton::right, down.middle_of(ViewKind::space), {0, 40});
  const auto lower = view_map(down.state, down.layout, down.document, ViewKind::space).to_px(near);
  CHECK(lower->y() > start.y() + 3);
}

TEST_CASE("two clicks within a third of a second fill the window with a view and later ones do not") {
  const auto after = [](double seconds, double px) {
    Desk desk;
    const Eigen::Vector2d at = desk.middle_of(ViewKind::sagittal);
    for (int click = 0; click < 2; ++click) {
      const double x = at.x() + (click == 1 ? px : 0);
      const auto send = [&](auto what) {
        handle_event(desk.state, {what, x, at.y(), false, false, false, 10 + click * seconds, false}, desk.context(),
                     desk.out);
      };
      send(MousePress{});
      send(MouseRelease{});
    }
    return desk.state.look.maximised;
  };
  CHECK(after(0.3, 0) == ViewKind::sagittal);
  CHECK_FALSE(after(0.4, 0));
  CHECK(after(0.1, 3) == ViewKind::sagittal);
  CHECK_FALSE(after(0.1, 6));
}

TEST_CASE("arrows scroll by one slice and pages by ten") {
  const auto scrolled = [](int code) {
    Desk desk;
    desk.send(MouseMove{}, desk.middle_of(ViewKind::axial).x(), desk.middle_of(ViewKind::axial).y());
    const double z = desk.state.look.crosshair_mm.z();
    desk.send(KeyPress{code}, desk.middle_of(ViewKind::axial).x(), desk.middle_of(ViewKind::axial).y());
    return (desk.state.look.crosshair_mm.z() - z) / desk.document.scan.image->geometry.spacing_mm.z();
  };
  CHECK(scrolled(key::up) == doctest::Approx(1));
  CHECK(scrolled(key::right) == doctest::Approx(1));
  CHECK(scrolled(key::down) == doctest::Approx(-1));
  CHECK(scrolled(key::left) == doctest::Approx(-1));
  CHECK(scrolled(key::page_up) == doctest::Approx(10));
  CHECK(scrolled(key::page_down) == doctest::Approx(-10));
}

TEST_CASE("each letter takes the tool that the list of keys names and each digit its reach") {
  for (const ToolKind* kind : tool_kinds) {
    if (*kind->key == '\0') continue;
    CAPTURE(kind->name);
    Desk desk;
    desk.state.hand.tool = kind->tool == MouseTool::grab ? MouseTool::pull : MouseTool::grab;
    desk.press(*kind->key);
    CHECK(desk.state.hand.tool == kind->tool);
  }
  for (const std::size_t preset : {0u, 1u, 2u}) {
    Desk desk;
    desk.press(static_cast<int>('1' + preset));
    CHECK(desk.state.hand.sigma_mm() == desk.state.hand.sigma_presets_mm[preset]);
  }
  const Desk desk;
  CHECK(desk.state.hand.sigma_presets_mm[0] < desk.state.hand.sigma_presets_mm[1]);
  CHECK(desk.state.hand.sigma_presets_mm[1] < desk.state.hand.sigma_presets_mm[2]);
}

TEST_CASE("keys show and hide what they are named for") {
  const auto shown = [](char letter) {
    Desk desk;
    const ShownParts before = desk.state.preferences.show;
    desk.press(letter);
    const ShownParts& after = desk.state.preferences.show;
    return std::pair(after.outline != before.outline, after.crosshair != before.crosshair);
  };
  CHECK(shown('O') == std::pair(true, false));
  CHECK(shown('X') == std::pair(false, true));
}

TEST_CASE("the touches of a brush lie half its radius apart") {
  Desk desk;
  desk.state.hand.tool = MouseTool::confirm;
  desk.state.hand.brush.radius_mm = 12;
  const Eigen::Vector2d at = desk.on_outline(ViewKind::axial);
  const double mm =
      1 / view_map(desk.state, desk.layout, desk.document, ViewKind::axial).mm_per_px(desk.state.look.crosshair_mm);
  drag(desk, MouseButton::left, at, {25 * mm, 0});
  const auto dabs = desk.sent<ApplyEdit>();
  REQUIRE(dabs.size() >= 3);
  for (std::size_t k = 1; k < dabs.size(); ++k)
    CHECK((std::get<Confirm>(dabs[k].action).at - std::get<Confirm>(dabs[k - 1].action).at).norm() ==
          doctest::Approx(6).epsilon(0.02));
  for (const ApplyEdit& dab : dabs) CHECK(std::get<Confirm>(dab.action).radius_mm == 12);
}

TEST_CASE("Alt turns a brush round") {
  for (const bool alt : {false, true}) {
    Desk desk;
    desk.state.hand.tool = MouseTool::confirm;
    const Eigen::Vector2d at = desk.on_outline(ViewKind::axial);
    const auto send = [&](auto what, double x_px, double seconds) {
      handle_event(desk.state, {what, x_px, at.y(), false, false, alt, seconds, false}, desk.context(), desk.out);
    };
    send(MousePress{}, at.x(), 1);
    send(MouseMove{}, at.x() + 5, 2);
    const auto dabs = desk.sent<ApplyEdit>();
    REQUIRE(!dabs.empty());
    CHECK(std::get<Confirm>(dabs[0].action).hold == !alt);
  }
}

TEST_CASE("the outline is taken hold of within eight px and not beyond") {
  const auto takes = [](double px) {
    Desk desk;
    const Eigen::Vector2d at = desk.on_outline(ViewKind::axial);
    // The outline's leftmost side: to the left of it is nothing else.
    double off_px = 0;
    for (; off_px < 40; ++off_px) {
      update_hover(desk.state, desk.context(), at.x() - off_px - 1, at.y());
      if (!desk.state.pointer.hover || !desk.state.pointer.hover->on_mesh) break;
    }
    return off_px >= px;
  };
  CHECK(takes(4));
  CHECK_FALSE(takes(14));
}

TEST_CASE("linked slices are zoomed together about the cross-hair and within limits") {
  Desk desk;
  desk.state.preferences.linked_zoom = true;
  const auto pan = [&](ViewKind kind) -> SlicePan& { return desk.state.look.slices[index_of(kind)]; };
  for (const ViewKind kind : slice_views) pan(kind) = {desk.state.look.crosshair_mm + Vec3(8, 4, -2), 1};
  zoom_slice(desk.state, ViewKind::coronal, 0.5);
  for (const ViewKind kind : slice_views) CHECK(pan(kind).mm_per_px == doctest::Approx(0.5));
  CHECK((pan(ViewKind::axial).centre_mm - desk.state.look.crosshair_mm - Vec3(4, 2, -1)).norm() < 1e-9);
  CHECK((pan(ViewKind::coronal).centre_mm - desk.state.look.crosshair_mm - Vec3(8, 4, -2)).norm() < 1e-9);
  desk.state.preferences.linked_zoom = false;
  zoom_slice(desk.state, ViewKind::axial, 1000);
  CHECK(pan(ViewKind::axial).mm_per_px == doctest::Approx(20));
  zoom_slice(desk.state, ViewKind::sagittal, 1e-6);
  CHECK(pan(ViewKind::sagittal).mm_per_px == doctest::Approx(0.005));
  CHECK(pan(ViewKind::coronal).mm_per_px == doctest::Approx(0.5));
  link_zoom(desk.state, true);
  for (const ViewKind kind : slice_views) CHECK(pan(kind).mm_per_px == doctest::Approx(20));  // all see as much
}

TEST_CASE("the key of slices in space goes through their looks and hides them last") {
  ShownParts parts;
  parts.planes = false;
  std::vector<std::pair<bool, PlaneLook>> looks;
  for (int press = 0; press < 4; ++press) {
    parts = with_next_planes(parts);
    looks.emplace_back(parts.planes, parts.plane_look);
  }
  CHECK(looks[0] == std::pair(true, PlaneLook::translucent));
  CHECK(looks[2] == std::pair(true, PlaneLook::solid));
  CHECK_FALSE(looks[3].first);
}

TEST_CASE("the handles of a placement are met at their knob and ring and within") {
  PlacementHandles handles;
  handles.centre_px = {100, 100};
  handles.radius_px = 50;
  handles.knob_px = handles.centre_px + 50 * Eigen::Vector2d(0.6, 0.8);
  const auto part = [&](double x, double y, float scale = 1) { return part_at(handles, x, y, scale); };
  CHECK(part(130, 140) == PlacePart::knob);
  CHECK(part(138, 140) == PlacePart::knob);
  CHECK(part(50, 100) == PlacePart::ring);
  CHECK(part(43, 100) == PlacePart::ring);
  CHECK(part(57, 100) == PlacePart::ring);
  CHECK(part(62, 100) == PlacePart::body);
  CHECK(part(100, 100) == PlacePart::body);
  CHECK(part(38, 100) == PlacePart::none);
  CHECK(part(38, 100, 2) == PlacePart::ring);
}

TEST_CASE("the nearest landmark within ten px and near the slice is met") {
  SliceView slice;  // axial: x to the right, y down
  const ViewMap map(RectPx{0, 0, 200, 200}, slice);
  const std::map<std::string, Vec3> landmarks{{"a", {0, 0, 0}}, {"b", {12, 0, 1}}, {"far", {0, 50, 5}}};
  const auto met = [&](double x_mm, double y_mm, double reach_mm = 3) {
    const Eigen::Vector2d px = *map.to_px(Vec3(x_mm, y_mm, 0));
    return landmark_at({map, px.x(), px.y()}, landmarks, reach_mm);
  };
  CHECK(met(4, 0) == "a");
  CHECK(met(7, 0) == "b");
  CHECK(met(0, 9) == "a");
  CHECK(met(0, 11).empty());
  CHECK(met(0, 50).empty());
  CHECK(met(0, 50, 6) == "far");
}

TEST_CASE("a px covers more mm behind the target than before it") {
  const Camera3D camera = camera_from(LookFrom::anterior, Box(Vec3(-50, -50, -50), Vec3(50, 50, 50)));
  const ViewMap map(RectPx{0, 0, 400, 300}, camera);
  const double at_target = map.mm_per_px(camera.target);
  CHECK(at_target == doctest::Approx(camera_mm_per_px(camera, 300)));
  const Vec3 away = camera.distance_mm / 2 * map.into_screen();
  CHECK(map.mm_per_px(camera.target + away) == doctest::Approx(1.5 * at_target));
  CHECK(map.mm_per_px(camera.target - away) == doctest::Approx(0.5 * at_target));
  CHECK(map.into_screen().y() == doctest::Approx(1));
}

TEST_CASE("Shift with a letter looks from the side that it begins") {
  for (std::size_t side = 0; side < side_letters.size(); ++side) {
    Desk desk;
    desk.state.look.camera.to_eye = Vec3(1, 1, 1).normalized();
    desk.send(KeyPress{side_letters[side]}, 300, 250, true);
    CHECK(direction_letters(desk.state.look.camera.to_eye) == std::string(1, side_letters[side]));
  }
}

TEST_CASE("keys with Ctrl do what they say and Shift makes them do more") {
  Desk desk;
  const ControlsContext context{desk.layout, desk.document, desk.mesh, true, true};
  const auto press = [&](int code, bool ctrl, bool shift) {
    press_key(desk.state, {KeyPress{code}, 300, 250, shift, ctrl, false, 1, false}, code, context, desk.out);
  };
  press('S', true, false);
  press('S', true, true);
  const auto saved = desk.sent<SaveCase>();
  REQUIRE(saved.size() == 2);
  CHECK_FALSE(saved[0].as);
  CHECK(saved[1].as);
  press('Z', true, false);
  press('Z', true, true);
  press('Y', true, false);
  const auto edits = desk.sent<ApplyEdit>();
  REQUIRE(edits.size() == 3);
  CHECK(std::holds_alternative<Undo>(edits[0].action));
  CHECK(std::holds_alternative<Redo>(edits[1].action));
  CHECK(std::holds_alternative<Redo>(edits[2].action));
  press('J', false, false);
  press('J', false, true);
  const auto looked = desk.sent<ShowFinding>();
  REQUIRE(looked.size() == 2);
  CHECK_FALSE(looked[0].back);
  CHECK(looked[1].back);
}

}  // namespace homolog
