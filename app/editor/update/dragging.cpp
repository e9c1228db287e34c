#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "app/editor/update/controls.h"
#include "app/editor/update/tools/tool.h"

namespace homolog {

namespace {

/// Whether a click of the tool in hand does nothing here, so that it may choose another structure.
bool click_is_free(const EditorState& state) {
  const ToolKind& tool = kind_of(state.hand.tool);
  const Hover& hover = *state.pointer.hover;
  const bool works_on_mesh = is_brush(tool.tool) || tool.marks == ToolMarks::handles;
  return tool.stroke || (works_on_mesh && !hover.on_mesh && hover.part == PlacePart::none);
}

/// Whether the press that has begun would edit the structure that is worked on.
bool press_edits(const EditorState& state) {
  return kind_of(state.pointer.begun_with).edits_at(*state.pointer.hover);
}

void start_left_drag(EditorState& state, const InputEvent& event, const ControlsContext& context, Outbox& out) {
  const Press press{state, event, context, out, *state.pointer.hover};
  const bool draws = event.ctrl && !press.in_space();
  state.pointer.begun_with = draws ? MouseTool::contour : state.hand.tool;
  state.pointer.pressed_structure = click_is_free(state) && !draws ? press.hover.structure : std::string();
  if (active_is_locked(state, context.document) && press_edits(state)) {
    if (state.pointer.pressed_structure.empty())
      add_notice(state, locked_sentence(*context.document.structure(context.structure)), false);
    return;
  }
  if (!kind_of(state.pointer.begun_with).begin(press) && press.in_space())
    state.pointer.drag = TurnDrag{event.x_px, event.y_px, state.look.camera};
}

}  // namespace

void start_drag(EditorState& state, const InputEvent& event, MouseButton button, const ControlsContext& context,
                Outbox& out) {
  const ViewKind kind = state.pointer.hover->view;
  const bool in_space = kind == ViewKind::space;
  state.pointer.drag_button = button;
  switch (button) {
    case MouseButton::left:
      return start_left_drag(state, event, context, out);
    case MouseButton::middle:
      state.pointer.drag = PanDrag{kind, event.x_px, event.y_px,
                                   in_space ? state.look.camera.target : state.look.slices[index_of(kind)].centre_mm};
      return;
    case MouseButton::right:
      if (in_space)
        state.pointer.drag = TurnDrag{event.x_px, event.y_px, state.look.camera};
      else
        state.pointer.drag = WindowLevelDrag{event.x_px, event.y_px, state.look.window_low, state.look.window_high};
      return;
  }
}

void move_drag(EditorState& state, const InputEvent& event, const ControlsContext& context, Outbox& out) {
  const auto map_of = [&](ViewKind kind) { return view_map(state, context.layout, context.document, kind); };
  const double scale = context.layout.scale;
  if (auto* pan = std::get_if<PanDrag>(&*state.pointer.drag)) {
    const ViewMap map = map_of(pan->view);
    const Vec3 anchor = pan->start_mm;
    const Vec3 moved =
        map.on_facing_plane(event.x_px, event.y_px, anchor) - map.on_facing_plane(pan->x_px, pan->y_px, anchor);
    (pan->view == ViewKind::space ? state.look.camera.target : state.look.slices[index_of(pan->view)].centre_mm) =
        pan->start_mm - moved;
  } else if (auto* window = std::get_if<WindowLevelDrag>(&*state.pointer.drag)) {
    // Sideways widens, upwards brightens, by shares of the width: the same feel for CT and MR.
    const double width = window->high - window->low, centre = (window->high + window->low) / 2;
    const double new_width = width * std::exp((event.x_px - window->x_px) / (200 * scale));
    const double new_centre = centre + (event.y_px - window->y_px) / (300 * scale) * width;
    state.look.window_low = new_centre - new_width / 2;
    state.look.window_high = new_centre + new_width / 2;
  } else if (auto* turn = std::get_if<TurnDrag>(&*state.pointer.drag)) {
    state.look.camera = turned(turn->start, (event.x_px - turn->x_px) / scale, (event.y_px - turn->y_px) / scale);
    state.preferences.hints.turned_camera = true;
  } else if (const ToolKind* tool = dragging_tool(state)) {
    tool->move({state, event, context, out});
  }
}

std::optional<Action> drag_action(const EditorState& state) {
  const ToolKind* tool = dragging_tool(state);
  return tool != nullptr ? tool->action(state) : std::nullopt;
}

namespace {

/// An edit by the mouse is done.
void commit(EditorState& state, const Action& action, const ControlsContext& context, Outbox& out) {
  out.apply(action);
  state.unsaved_found = 0;  // the sentence about them has been seen by now; the button stays
  kind_of(state.pointer.begun_with).follow(state, action, context, out);
}

}  // namespace

void do_held_click(EditorState& state, const ControlsContext& context, Outbox& out) {
  if (!state.pointer.held_click) return;
  const HeldClick click = *std::exchange(state.pointer.held_click, std::nullopt);
  if (click.action)
    commit(state, *click.action, context, out);
  else
    add_notice(state, click.notice);
}

void settle_click(EditorState& state, double seconds, const ControlsContext& context, Outbox& out) {
  if (state.pointer.held_click && seconds >= state.pointer.held_click->until) do_held_click(state, context, out);
  auto* brush = state.pointer.drag ? std::get_if<BrushDrag>(&*state.pointer.drag) : nullptr;
  if (brush == nullptr || !brush->waits_until || seconds < *brush->waits_until) return;
  brush->waits_until.reset();
  paint_to(state, context, brush->x_px, brush->y_px, out);
}

void finish_drag(EditorState& state, const InputEvent& event, const ControlsContext& context, Outbox& out) {
  auto* brush = std::get_if<BrushDrag>(&*state.pointer.drag);
  const bool waits = brush != nullptr && brush->waits_until.has_value();
  const bool may_be_double = state.pointer.drag_button == MouseButton::left && near_last_press(state, event);
  if (waits && !may_be_double) {
    brush->waits_until.reset();
    paint_to(state, context, event.x_px, event.y_px, out);
  } else if (const auto action = waits ? first_dab(state, context) : drag_action(state)) {
    if (may_be_double)
      state.pointer.held_click = HeldClick{action, {}, state.pointer.last_press.seconds + double_click_seconds};
    else
      commit(state, *action, context, out);
  }
  if (const ToolKind* tool = dragging_tool(state)) tool->finish(state);
  state.pointer.drag.reset();
}

void cancel_drag(EditorState& state, Outbox& out) {
  const auto* brush = std::get_if<BrushDrag>(&*state.pointer.drag);
  if (drag_action(state) || (brush != nullptr && brush->waits_until)) out.preview(std::nullopt);
  if (const auto* window = std::get_if<WindowLevelDrag>(&*state.pointer.drag)) {
    state.look.window_low = window->low;
    state.look.window_high = window->high;
  } else if (const auto* turn = std::get_if<TurnDrag>(&*state.pointer.drag)) {
    state.look.camera = turn->start;
  } else if (const ToolKind* tool = dragging_tool(state)) {
    tool->cancel(state);
  }
  state.pointer.drag.reset();
}

}  // namespace homolog
