#include "app/editor/update/controls.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "app/editor/state/views.h"
#include "app/editor/update/tools/tool.h"

namespace homolog {

namespace {

constexpr double wheel_zoom = 1.12, wheel_sigma = 1.1, pick_reach_units = 8;

void turn_wheel(EditorState& state, const InputEvent& event, double steps, const ControlsContext& context,
                Outbox& out) {
  if (state.pointer.drag && std::holds_alternative<StrokeDrag>(*state.pointer.drag)) {
    turn_sigma(state, state.hand.sigma_mm() * std::pow(wheel_sigma, steps));
    std::get<StrokeDrag>(*state.pointer.drag).stroke.sigma_mm = state.hand.sigma_mm();
    if (const auto action = drag_action(state)) out.preview(action);
    return;
  }
  if (!state.pointer.hover || event.over_panel) return;
  const ViewKind kind = state.pointer.hover->view;
  // A curve that is being drawn lies in the slice where it began.
  if (state.pointer.drag && std::holds_alternative<ContourDrag>(*state.pointer.drag) && !event.ctrl) return;
  if (kind == ViewKind::space) {
    state.look.camera.distance_mm =
        std::clamp(state.look.camera.distance_mm * std::pow(wheel_zoom, -steps), 5.0, 20000.0);
  } else if (event.ctrl) {
    // The point under the pointer stays where it is.
    const Vec3 before = view_map(state, context.layout, context.document, kind)
                            .on_facing_plane(event.x_px, event.y_px, state.look.crosshair_mm);
    SlicePan& pan = state.look.slices[index_of(kind)];
    zoom_slice(state, kind, pan.mm_per_px * std::pow(wheel_zoom, -steps));
    const Vec3 after = view_map(state, context.layout, context.document, kind)
                           .on_facing_plane(event.x_px, event.y_px, state.look.crosshair_mm);
    pan.centre_mm += before - after;
  } else {
    scroll_slice(state, kind, context.document, steps);
    state.preferences.hints.scrolled = true;
  }
}

/// Counts a press of the left button: 1 for the first at its place, 2 for that of a double click, and so on.
int count_click(EditorState& state, const InputEvent& event) {
  const int clicks = near_last_press(state, event) ? state.pointer.last_press.clicks + 1 : 1;
  if (clicks == 1) {
    state.pointer.last_press.ruler = state.hand.ruler;
    state.pointer.last_press.camera = state.look.camera;
    state.pointer.last_press.played = state.look.playing;
  }
  state.pointer.last_press.x_px = event.x_px;
  state.pointer.last_press.y_px = event.y_px;
  state.pointer.last_press.seconds = event.seconds;
  return state.pointer.last_press.clicks = clicks;
}

/// A view fills the window, or all four are seen again. What the click before began is taken back: it was none.
void double_click(EditorState& state, Outbox& out) {
  if (state.pointer.held_click && state.pointer.held_click->action) out.preview(std::nullopt);
  state.pointer.held_click.reset();
  state.hand.ruler = state.pointer.last_press.ruler;
  const ViewKind kind = state.pointer.hover->view;
  if (kind == ViewKind::space) state.look.camera = state.pointer.last_press.camera;
  if (state.pointer.last_press.played && !state.look.playing) out.send(PlayFrames{true});
  state.look.maximised = state.look.maximised ? std::nullopt : std::optional(kind);
}

/// Whether a click that is held is a click by now: the time is over, or something else begins.
bool ends_held_click(const EditorState& state, const InputEvent& event) {
  if (event.seconds >= state.pointer.held_click->until) return true;
  if (std::holds_alternative<MouseMove>(event.what) || std::holds_alternative<MouseRelease>(event.what)) return false;
  const auto* press = std::get_if<MousePress>(&event.what);
  return press == nullptr || press->button != MouseButton::left || event.over_panel || !near_last_press(state, event);
}

/// A press on another structure that moved nothing works on that one from now on.
void choose_pressed(EditorState& state, const InputEvent& event, Outbox& out) {
  const std::string id = std::exchange(state.pointer.pressed_structure, {});
  constexpr double still_px = 3;
  const LastPress& press = state.pointer.last_press;
  if (id.empty() || std::hypot(event.x_px - press.x_px, event.y_px - press.y_px) > still_px) return;
  out.send(ChooseStructure{id});
}

/// Whether an event acts on what lies under the pointer now: a press that begins something, and a drag that follows the
/// mesh.
bool points(const EditorState& state, const InputEvent& event) {
  if (std::holds_alternative<MousePress>(event.what)) return !state.pointer.drag && !event.over_panel && !state.dialog;
  const ToolKind* tool = dragging_tool(state);
  return std::holds_alternative<MouseMove>(event.what) && tool != nullptr && tool->follows_mesh;
}

}  // namespace

ViewMap view_map(const EditorState& state, const Layout& layout, const Document& document, ViewKind kind) {
  const RectPx& rect = layout.image(kind);
  if (kind == ViewKind::space) return {rect, state.look.camera};
  return {rect, slice_view(state, kind, geometry_of(document))};
}

std::optional<Vec3> mesh_at(const EditorState& state, const ControlsContext& context, const Pointing& at,
                            double reach_mm) {
  const auto& [map, x_px, y_px, scale] = at;
  if (map.is_slice())
    return context.mesh.nearest_on_outline(*context.shape(), map.slice(),
                                           map.on_facing_plane(x_px, y_px, state.look.crosshair_mm), reach_mm);
  const Ray ray = map.ray(x_px, y_px);
  const auto hit = context.mesh.first_on_surface(*context.shape(), ray);
  const bool hidden =
      hit && hidden_by_planes(shown_planes(state, context.document), geometry_of(context.document), ray, *hit);
  return hidden ? std::nullopt : hit;
}

namespace {

/// The other structure that a click at a px would choose: in a slice the one whose outline is nearest, nearer than that
/// of the active one; in space the first one on the ray where the active one is not. Empty: none.
std::string other_structure_at(const EditorState& state, const ControlsContext& context, const ViewMap& map,
                               const Hover& hover, double pick_mm) {
  const Structure* active = context.document.structure(context.structure);
  const bool in_space = !map.is_slice();
  if (in_space && state.look.structures.others_opacity <= 0) return {};
  if (context.document.structures.size() < 2 || state.pointer.drag || (in_space && hover.on_mesh)) return {};
  const Ray ray = map.ray(hover.x_px, hover.y_px);
  const Vec3 from = in_space ? ray.from : *hover.p_mm;
  double nearest = in_space        ? std::numeric_limits<double>::infinity()
                   : hover.on_mesh ? std::min(pick_mm, (*hover.on_mesh - from).norm())
                                   : pick_mm;
  std::string found;
  for (const auto& one : context.document.structures) {
    const Shape* shape = one->shape(context.document.frame);
    if (one.get() == active || shape == nullptr || !state.look.structures.shows(one->id)) continue;
    const ShapeView view{*one, *shape, context.document.frame};
    const auto at = in_space ? context.mesh.first_on_surface(view, ray)
                             : context.mesh.nearest_on_outline(view, map.slice(), from, nearest);
    if (!at || (*at - from).norm() >= nearest) continue;
    nearest = (*at - from).norm();
    found = one->id;
  }
  return found;
}

}  // namespace

void update_hover(EditorState& state, const ControlsContext& context, double x_px, double y_px) {
  const auto kind = context.layout.view_at(x_px, y_px);
  if (!kind) {
    state.pointer.hover.reset();
    return;
  }
  Hover hover;
  hover.view = *kind;
  hover.x_px = x_px;
  hover.y_px = y_px;
  const ViewMap map = view_map(state, context.layout, context.document, *kind);
  if (map.is_slice()) hover.p_mm = map.on_facing_plane(x_px, y_px, state.look.crosshair_mm);
  const float scale = context.layout.scale;
  const Pointing at{map, x_px, y_px, scale};
  const double pick_mm = pick_reach_units * scale * map.mm_per_px(state.look.crosshair_mm);
  if (const auto shown = context.shape(); shown && active_is_shown(state, context.document)) {
    const Points& points = *shown->shape.points;
    const double reach_mm = is_brush(state.hand.tool) ? std::max(pick_mm, state.hand.brush.radius_mm) : pick_mm;
    hover.on_mesh = mesh_at(state, context, at, reach_mm);
    if (!map.is_slice()) hover.p_mm = hover.on_mesh;
    constexpr double landmark_share = 0.012;  // of the organ: how thick a placed landmark is
    const double slice_reach_mm =
        0.75 * slice_step_mm(geometry_of(context.document), map.into_screen()) + landmark_share * state.look.organ_mm;
    hover.landmark = landmark_at(at, shown->shape.landmarks, slice_reach_mm);
    if (kind_of(state.hand.tool).marks == ToolMarks::handles)
      if (const auto handles = placement_handles(map, points, scale)) hover.part = part_at(*handles, x_px, y_px, scale);
  }
  hover.structure = other_structure_at(state, context, map, hover, pick_mm);
  state.pointer.hover = std::move(hover);
}

bool near_last_press(const EditorState& state, const InputEvent& event) {
  const LastPress& last = state.pointer.last_press;
  return last.clicks > 0 && event.seconds - last.seconds < double_click_seconds &&
         std::hypot(event.x_px - last.x_px, event.y_px - last.y_px) < double_click_px;
}

void handle_event(EditorState& state, const InputEvent& event, const ControlsContext& given, Outbox& out) {
  state.active = true;
  ControlsContext context = given;
  if (state.pointer.held_click && ends_held_click(state, event)) {
    context.can_undo = context.can_undo || state.pointer.held_click->action;
    do_held_click(state, context, out);
  }
  const double last_x_px = state.pointer.hover ? state.pointer.hover->x_px : event.x_px;
  const double last_y_px = state.pointer.hover ? state.pointer.hover->y_px : event.y_px;
  // What the pointer is over is looked up once: before a press or a drag that needs it, else after what the event did.
  const bool pointed = points(state, event);
  if (pointed) update_hover(state, context, event.x_px, event.y_px);

  if (const auto* pressed = std::get_if<KeyPress>(&event.what)) {
    press_key(state, event, pressed->key, context, out);
  } else if (const auto* press = std::get_if<MousePress>(&event.what)) {
    if (!pointed || !state.pointer.hover) return;
    const int clicks = press->button == MouseButton::left ? count_click(state, event) : 1;
    if (clicks == 1)
      start_drag(state, event, press->button, context, out);
    else if (clicks % 2 == 0)
      double_click(state, out);
    return;
  } else if (const auto* release = std::get_if<MouseRelease>(&event.what)) {
    if (state.pointer.drag && release->button == state.pointer.drag_button) finish_drag(state, event, context, out);
    if (release->button == MouseButton::left) choose_pressed(state, event, out);
  } else if (const auto* wheel = std::get_if<Wheel>(&event.what)) {
    turn_wheel(state, event, wheel->steps, context, out);
  } else if (state.pointer.drag) {
    move_drag(state, event, context, out);
  }
  if (event.over_panel && !state.pointer.drag) {
    state.pointer.hover.reset();
    return;
  }
  if (!pointed) update_hover(state, context, event.x_px, event.y_px);
  // A key that is let go with Shift held comes as a movement to where the pointer is already.
  const bool moved = last_x_px != event.x_px || last_y_px != event.y_px;
  const bool moves_crosshair =
      std::holds_alternative<MouseMove>(event.what) && moved && event.shift && !state.pointer.drag;
  if (moves_crosshair && state.pointer.hover && state.pointer.hover->p_mm) {
    state.look.crosshair_mm = *state.pointer.hover->p_mm;
    settle_crosshair(state, context.document);
  }
}

}  // namespace homolog
