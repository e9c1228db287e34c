#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "app/editor/update/controls.h"
#include "app/editor/work/snaps.h"

namespace homolog {

namespace {

/// Where a dab goes whose circle is drawn at a px; nullopt where it covers nothing of the mesh.
std::optional<Vec3> dab_at(const EditorState& state, const ControlsContext& context, const ViewMap& map, double x_px,
                           double y_px) {
  const auto on_mesh = mesh_at(state, context, map, x_px, y_px, state.brush.radius_mm);
  const bool fills = state.tool == MouseTool::stiffness && state.brush.paints == BrushPaints::fill;
  if (!on_mesh || fills || !map.is_slice()) return on_mesh;
  return map.on_facing_plane(x_px, y_px, state.crosshair_mm);
}

/// Dabs half a radius apart along the pointer's path to a px. Their places do not depend on how many events told of the
/// path: they are counted along it, in fractions of a px that are exact.
void paint_to(EditorState& state, const ControlsContext& context, double x_px, double y_px, Outbox& out) {
  constexpr double parts_of_px = 256;
  auto& drag = std::get<BrushDrag>(*state.drag);
  const ViewMap map = view_map(state, context.layout, context.document, drag.view);
  const bool fills = state.tool == MouseTool::stiffness && state.brush.paints == BrushPaints::fill;
  const Eigen::Vector2d from(drag.x_px, drag.y_px), to(x_px, y_px);
  const double length_px = (to - from).norm();
  double along_px = drag.to_next_px;
  for (; along_px <= length_px && !(fills && drag.painted);) {
    const Eigen::Vector2d exact = length_px > 0 ? Eigen::Vector2d(from + along_px / length_px * (to - from)) : from;
    const Eigen::Vector2d px = (exact * parts_of_px).array().round() / parts_of_px;
    const auto at = dab_at(state, context, map, px.x(), px.y());
    if (at) {
      out.apply(*brush_action(state, context.document, *at), drag.painted);
      drag.painted = true;
    }
    const double step_mm = state.brush.radius_mm / 2;
    along_px += std::max(1.0, step_mm / map.mm_per_px(at ? *at : state.crosshair_mm));
  }
  drag.to_next_px = along_px - length_px;
  drag.x_px = x_px;
  drag.y_px = y_px;
}

/// The dab at the press of a brush that has not begun to paint; nullopt where it covers nothing of the mesh.
std::optional<Action> first_dab(const EditorState& state, const ControlsContext& context) {
  const auto& drag = std::get<BrushDrag>(*state.drag);
  const ViewMap map = view_map(state, context.layout, context.document, drag.view);
  const auto at = dab_at(state, context, map, drag.x_px, drag.y_px);
  return at ? brush_action(state, context.document, *at) : std::nullopt;
}

/// A press of the left button: where, and what lies there.
struct Press {
  EditorState& state;
  const InputEvent& event;
  const ControlsContext& context;
  Outbox& out;
  const Hover& hover;

  const Document& document() const { return context.document; }
  ViewMap map() const { return view_map(state, context.layout, document(), hover.view); }
  bool in_space() const { return hover.view == ViewKind::space; }
  /// What is taken hold of belongs to the frame that is shown.
  void stay_at_frame() const {
    if (state.playing) out.send(PlayFrames{false});
  }
  /// A press that asks for something at once does so when it can be no double click.
  bool hold(HeldClick click) const {
    click.until = event.seconds + double_click_seconds;
    state.held_click = std::move(click);
    return true;
  }
};

// What each tool begins with a press. False where there is nothing for it.

bool start_stroke(const Press& press, Tool tool) {
  EditorState& state = press.state;
  const Hover& hover = press.hover;
  if (!hover.on_mesh) return false;
  press.stay_at_frame();
  StrokeDrag drag;
  drag.view = hover.view;
  drag.stroke.tool = tool;
  drag.stroke.at = drag.stroke.to = *hover.on_mesh;
  drag.stroke.sigma_mm = state.sigma_mm();
  drag.stroke.through_space = state.through_space;
  drag.stroke.strength = state.relax_strength;
  drag.press_mm = press.map().on_facing_plane(press.event.x_px, press.event.y_px, *hover.on_mesh);
  state.drag = drag;
  return true;
}

bool start_placing(const Press& press) {
  EditorState& state = press.state;
  const Hover& hover = press.hover;
  if (hover.part == PlacePart::none || !press.document().view()) return false;
  press.stay_at_frame();
  PlaceDrag drag;
  drag.view = hover.view;
  drag.part = hover.part;
  drag.start = drag.now = press.document().view()->shape.placement;
  drag.centre_mm = bounds_of(*press.document().view()->shape.points).center();
  drag.press_mm = press.map().on_facing_plane(press.event.x_px, press.event.y_px, drag.centre_mm);
  state.drag = drag;
  return true;
}

bool start_landmark(const Press& press) {
  EditorState& state = press.state;
  const Hover& hover = press.hover;
  if (!press.document().view() || !hover.p_mm) return false;
  press.stay_at_frame();
  const auto& placed = press.document().view()->shape.landmarks;
  if (const auto known = placed.find(hover.landmark); known != placed.end()) {
    state.drag = LandmarkDrag{hover.view, known->first, known->second, known->second - *hover.p_mm, false};
    return true;
  }
  const std::string name = landmark_in_hand(state, press.document());
  if (name.empty()) return false;
  state.drag = LandmarkDrag{hover.view, name, *hover.p_mm};
  press.out.preview(drag_action(state));
  return true;
}

bool start_brush(const Press& press) {
  EditorState& state = press.state;
  const Hover& hover = press.hover;
  if (!press.document().view() || (!hover.on_mesh && press.in_space())) return false;
  if (paints_regions(state) && press.document().structure()->paint.regions->list.empty())
    return press.hold({{}, "There is no region to paint yet. Add one first (Template, Regions)."});
  press.stay_at_frame();
  state.drag = BrushDrag{hover.view,
                         press.event.x_px,
                         press.event.y_px,
                         0,
                         false,
                         press.event.alt,
                         press.event.seconds + double_click_seconds};
  if (const auto dab = first_dab(state, press.context)) press.out.preview(dab);
  return true;
}

bool set_template_landmark(const Press& press) {
  EditorState& state = press.state;
  const Hover& hover = press.hover;
  if (!hover.on_mesh) return false;
  if (state.template_landmark.empty())
    return press.hold({{}, "Type the landmark's name first (Template), or choose one in the list to move it."});
  return press.hold({SetTemplateLandmark{state.template_landmark, *hover.on_mesh}, {}});
}

bool start_ruler(const Press& press) {
  if (!press.hover.p_mm) return false;
  press.state.ruler = Ruler{*press.hover.p_mm, *press.hover.p_mm};
  press.state.drag = RulerDrag{press.hover.view};
  return true;
}

bool start_tool(const Press& press) {
  const MouseTool tool = press.state.tool;
  if (const auto stroke = stroke_tool(tool)) return start_stroke(press, *stroke);
  if (is_brush(tool)) return start_brush(press);
  switch (tool) {
    case MouseTool::place:
      return start_placing(press);
    case MouseTool::landmark:
      return start_landmark(press);
    case MouseTool::template_landmark:
      return set_template_landmark(press);
    case MouseTool::ruler:
      return start_ruler(press);
    default:
      return false;
  }
}

void start_left_drag(EditorState& state, const InputEvent& event, const ControlsContext& context, Outbox& out) {
  const Press press{state, event, context, out, *state.hover};
  if (!start_tool(press) && press.in_space()) state.drag = TurnDrag{event.x_px, event.y_px, state.camera};
}

}  // namespace

std::optional<Action> brush_action(const EditorState& state, const Document& document, const Vec3& at) {
  const auto* drag = state.drag ? std::get_if<BrushDrag>(&*state.drag) : nullptr;
  const bool reversed = drag != nullptr && drag->reversed;
  const BrushSettings& brush = state.brush;
  if (state.tool == MouseTool::stiffness) {
    const auto& regions = document.structure()->paint.regions->list;
    const bool known =
        std::any_of(regions.begin(), regions.end(), [&](const Region& one) { return one.name == brush.region; });
    const std::string chosen = known || regions.empty() ? brush.region : regions.front().name;
    const std::string region = reversed || brush.erases ? std::string() : chosen;
    switch (brush.paints) {
      case BrushPaints::factor:
        return PaintStiffness{at, brush.radius_mm,
                              document.structure()->paint.base * (reversed ? 1 : brush.stiffness_factor), brush.soft};
      case BrushPaints::region:
        return PaintRegion{region, at, brush.radius_mm, brush.soft};
      case BrushPaints::smooth:
        return SmoothStiffness{at, brush.radius_mm, 0.5};
      case BrushPaints::fill:
        return FillRegion{region, at, brush.fill_by, brush.fill_tolerance_per_mm};
    }
  }
  if (state.tool == MouseTool::confirm) return Confirm{at, state.brush.radius_mm, state.brush.hold != reversed};
  return std::nullopt;
}

void start_drag(EditorState& state, const InputEvent& event, MouseButton button, const ControlsContext& context,
                Outbox& out) {
  const ViewKind kind = state.hover->view;
  const bool in_space = kind == ViewKind::space;
  state.drag_button = button;
  switch (button) {
    case MouseButton::left:
      return start_left_drag(state, event, context, out);
    case MouseButton::middle:
      state.drag = PanDrag{kind, event.x_px, event.y_px,
                           in_space ? state.camera.target : state.slices[index_of(kind)].centre_mm};
      return;
    case MouseButton::right:
      if (in_space)
        state.drag = TurnDrag{event.x_px, event.y_px, state.camera};
      else
        state.drag = WindowLevelDrag{event.x_px, event.y_px, state.window_low, state.window_high};
      return;
  }
}

void move_drag(EditorState& state, const InputEvent& event, const ControlsContext& context, Outbox& out) {
  const auto map_of = [&](ViewKind kind) { return view_map(state, context.layout, context.document, kind); };
  const double scale = context.layout.scale;
  if (auto* pan = std::get_if<PanDrag>(&*state.drag)) {
    const ViewMap map = map_of(pan->view);
    const Vec3 anchor = pan->start_mm;
    const Vec3 moved =
        map.on_facing_plane(event.x_px, event.y_px, anchor) - map.on_facing_plane(pan->x_px, pan->y_px, anchor);
    (pan->view == ViewKind::space ? state.camera.target : state.slices[index_of(pan->view)].centre_mm) =
        pan->start_mm - moved;
  } else if (auto* window = std::get_if<WindowLevelDrag>(&*state.drag)) {
    // Sideways widens, upwards brightens, by shares of the width: the same feel for CT and MR.
    const double width = window->high - window->low, centre = (window->high + window->low) / 2;
    const double new_width = width * std::exp((event.x_px - window->x_px) / (200 * scale));
    const double new_centre = centre + (event.y_px - window->y_px) / (300 * scale) * width;
    state.window_low = new_centre - new_width / 2;
    state.window_high = new_centre + new_width / 2;
  } else if (auto* turn = std::get_if<TurnDrag>(&*state.drag)) {
    state.camera = turned(turn->start, (event.x_px - turn->x_px) / scale, (event.y_px - turn->y_px) / scale);
    state.preferences.hints.turned_camera = true;
  } else if (auto* stroke = std::get_if<StrokeDrag>(&*state.drag)) {
    const Vec3 cursor = map_of(stroke->view).on_facing_plane(event.x_px, event.y_px, stroke->stroke.at);
    stroke->stroke.to = stroke->stroke.at + (cursor - stroke->press_mm);
    stroke->moved = stroke->moved || cursor != stroke->press_mm;
    if (stroke->moved) out.preview(stroke->stroke);
  } else if (auto* place = std::get_if<PlaceDrag>(&*state.drag)) {
    place->now = dragged_placement(*place, map_of(place->view), event.x_px, event.y_px);
    out.preview(SetPlacement{place->now});
  } else if (auto* landmark = std::get_if<LandmarkDrag>(&*state.drag)) {
    if (state.hover && state.hover->view == landmark->view && state.hover->p_mm) {
      const Vec3 to = *state.hover->p_mm + landmark->from_pointer;
      landmark->moved = landmark->moved || to != landmark->to;
      landmark->to = to;
      out.preview(drag_action(state));
    }
  } else if (auto* brush = std::get_if<BrushDrag>(&*state.drag)) {
    if (brush->waits_until && event.seconds < *brush->waits_until &&
        std::hypot(event.x_px - brush->x_px, event.y_px - brush->y_px) < double_click_px)
      return;
    brush->waits_until.reset();
    paint_to(state, context, event.x_px, event.y_px, out);
  } else if (auto* ruler = std::get_if<RulerDrag>(&*state.drag)) {
    // In space both ends lie on the surface: a length across the screen would be too short.
    if (state.hover && state.hover->view == ruler->view && state.hover->p_mm) state.ruler->to = *state.hover->p_mm;
  }
}

std::optional<Action> drag_action(const EditorState& state) {
  if (!state.drag) return std::nullopt;
  if (const auto* stroke = std::get_if<StrokeDrag>(&*state.drag))
    return stroke->moved ? std::optional<Action>(stroke->stroke) : std::nullopt;
  if (const auto* place = std::get_if<PlaceDrag>(&*state.drag))
    return place->now == place->start ? std::nullopt : std::optional<Action>(SetPlacement{place->now});
  if (const auto* landmark = std::get_if<LandmarkDrag>(&*state.drag))
    return landmark->moved ? std::optional<Action>(PlaceLandmark{landmark->name, landmark->to}) : std::nullopt;
  return std::nullopt;
}

namespace {

/// What follows from an edit by the mouse that is done.
void commit(EditorState& state, const Action& action, const ControlsContext& context, Outbox& out) {
  // A new one is done with its click; whoever moves those that are there may go on in their list.
  if (const auto* named = std::get_if<SetTemplateLandmark>(&action)) {
    const auto& known = context.document.structure()->the_template->landmarks;
    if (std::none_of(known.begin(), known.end(), [&](const Landmark& one) { return one.name == named->name; }))
      state.tool = state.tool_before_naming;
    state.template_landmark.clear();
  }
  out.apply(action);
  state.unsaved_found = 0;  // the sentence about them has been seen by now; the button stays
  if (const auto* stroke = std::get_if<Stroke>(&action)) {
    state.preferences.hints.dragged = true;
    if (moves_boundary(stroke->tool)) {
      if (state.snap.with_strokes && context.document.scan.image)
        out.send(SnapMesh{snap_region(*context.document.view(), *stroke), true});
      if (state.model_help > 0) out.send(CompleteByModel{});
    }
  }
  if (const auto* placed = std::get_if<PlaceLandmark>(&action)) {
    state.landmark = next_unplaced_landmark(context.document, placed->name);
    const auto& volume = context.document.scan.image;
    if (volume && placed->at && !volume->geometry.holds(*placed->at))
      add_notice(state, "\"" + placed->name +
                            "\" was placed outside the image, where nothing shows its place. Undo takes it back.");
  }
}

}  // namespace

void do_held_click(EditorState& state, const ControlsContext& context, Outbox& out) {
  if (!state.held_click) return;
  const HeldClick click = *std::exchange(state.held_click, std::nullopt);
  if (click.action)
    commit(state, *click.action, context, out);
  else
    add_notice(state, click.notice);
}

void settle_click(EditorState& state, double seconds, const ControlsContext& context, Outbox& out) {
  if (state.held_click && seconds >= state.held_click->until) do_held_click(state, context, out);
  auto* brush = state.drag ? std::get_if<BrushDrag>(&*state.drag) : nullptr;
  if (brush == nullptr || !brush->waits_until || seconds < *brush->waits_until) return;
  brush->waits_until.reset();
  paint_to(state, context, brush->x_px, brush->y_px, out);
}

void finish_drag(EditorState& state, const InputEvent& event, const ControlsContext& context, Outbox& out) {
  auto* brush = std::get_if<BrushDrag>(&*state.drag);
  const bool waits = brush != nullptr && brush->waits_until.has_value();
  const bool may_be_double = state.drag_button == MouseButton::left && near_last_press(state, event);
  if (waits && !may_be_double) {
    brush->waits_until.reset();
    paint_to(state, context, event.x_px, event.y_px, out);
  } else if (const auto action = waits ? first_dab(state, context) : drag_action(state)) {
    if (may_be_double)
      state.held_click = HeldClick{action, {}, state.last_press.seconds + double_click_seconds};
    else
      commit(state, *action, context, out);
  }
  if (std::holds_alternative<RulerDrag>(*state.drag) && state.ruler->length_mm() == 0) state.ruler.reset();
  state.drag.reset();
}

void cancel_drag(EditorState& state, Outbox& out) {
  const auto* brush = std::get_if<BrushDrag>(&*state.drag);
  if (drag_action(state) || (brush != nullptr && brush->waits_until)) out.preview(std::nullopt);
  if (const auto* window = std::get_if<WindowLevelDrag>(&*state.drag)) {
    state.window_low = window->low;
    state.window_high = window->high;
  } else if (const auto* turn = std::get_if<TurnDrag>(&*state.drag)) {
    state.camera = turn->start;
  } else if (std::holds_alternative<RulerDrag>(*state.drag)) {
    state.ruler.reset();
  }
  state.drag.reset();
}

}  // namespace homolog
