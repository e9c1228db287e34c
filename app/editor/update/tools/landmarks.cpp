#include <algorithm>

#include "app/editor/state/icons.h"
#include "app/editor/update/tools/tool.h"
#include "core/base/text/in_quotes.h"

namespace homolog {

namespace {

// A landmark of the case: its place in the image.

bool begin_landmark(const Press& press) {
  EditorState& state = press.state;
  const Hover& hover = press.hover;
  if (!press.shape() || !hover.p_mm) return false;
  press.stay_at_frame();
  const auto& placed = press.shape()->shape.landmarks;
  if (const auto known = placed.find(hover.landmark); known != placed.end()) {
    state.pointer.drag = LandmarkDrag{hover.view, known->first, known->second, known->second - *hover.p_mm, false};
    return true;
  }
  const std::string name = landmark_in_hand(state, press.document());
  if (name.empty()) return false;
  state.pointer.drag = LandmarkDrag{hover.view, name, *hover.p_mm};
  press.out.preview(drag_action(state));
  return true;
}

void move_landmark(const DragStep& step) {
  auto& drag = std::get<LandmarkDrag>(*step.state.pointer.drag);
  const auto over = step.over(drag.view);
  if (!over) return;
  const Vec3 to = *over + drag.from_pointer;
  drag.moved = drag.moved || to != drag.to;
  drag.to = to;
  step.out.preview(drag_action(step.state));
}

std::optional<Action> landmark_action(const EditorState& state) {
  const auto& drag = std::get<LandmarkDrag>(*state.pointer.drag);
  return drag.moved ? std::optional<Action>(PlaceLandmark{drag.name, drag.to}) : std::nullopt;
}

void follow_landmark(EditorState& state, const Action& action, const ControlsContext& context, Outbox&) {
  const auto& placed = std::get<PlaceLandmark>(action);
  state.hand.landmark = next_unplaced_landmark(*context.shape(), placed.name);
  const auto& volume = context.document.scan.image;
  if (volume && placed.at && !volume->geometry.holds(*placed.at))
    add_notice(state, "\"" + placed.name +
                          "\" was placed outside the image, where nothing shows its place. Undo takes it back.");
}

std::string landmark_hint(const EditorState& state, const Document& shown) {
  const std::size_t landmarks = active_structure(state, shown)->the_template->landmarks.size();
  if (landmarks == 0) return "This template has no landmarks yet. Name some of its points first (Template).";
  const std::string wanted = landmark_in_hand(state, shown);
  if (wanted.empty())
    return landmarks == 1 ? "The landmark is placed; drag it to move it."
                          : "All " + std::to_string(landmarks) + " landmarks are placed; drag one to move it.";
  return active_shape(state, shown)->shape.landmarks.contains(wanted)
             ? "Click where " + in_quotes(wanted) + " is now, or drag it there."
             : "Click where " + in_quotes(wanted) + " is.";
}

// A landmark of the template: a point of its surface.

bool begin_template_landmark(const Press& press) {
  EditorState& state = press.state;
  const Hover& hover = press.hover;
  if (!hover.on_mesh) return false;
  if (state.hand.template_landmark.empty())
    return press.hold({{}, "Type the landmark's name first (Template), or choose one in the list to move it."});
  return press.hold({SetTemplateLandmark{state.hand.template_landmark, *hover.on_mesh}, {}});
}

void follow_template_landmark(EditorState& state, const Action& action, const ControlsContext& context, Outbox&) {
  // A new one is done with its click; whoever moves those that are there may go on in their list.
  const auto& known = context.shape()->the_template().landmarks;
  const auto& name = std::get<SetTemplateLandmark>(action).name;
  if (std::none_of(known.begin(), known.end(), [&](const Landmark& one) { return one.name == name; }))
    state.hand.tool = state.hand.tool_before_naming;
  state.hand.template_landmark.clear();
}

std::string template_landmark_hint(const EditorState& state, const Document&) {
  return state.hand.template_landmark.empty()
             ? "Type a landmark's name, or choose one in the list to move it (Template)."
             : "Click the point of the mesh that is " + in_quotes(state.hand.template_landmark) + ".";
}

}  // namespace

constinit const ToolKind landmark_tool{.tool = MouseTool::landmark,
                                       .name = "Landmark",
                                       .log_name = "landmark",
                                       .key = "L",
                                       .in_keys = "Landmarks",
                                       .glyph = icon::landmark,
                                       .tip = "Landmark (L): click the place of the landmark in the image",
                                       .ends_group = true,
                                       .section = place_section,
                                       .cursor = hand_over_landmarks,
                                       .hint = landmark_hint,
                                       .follows_mesh = true,
                                       .names_landmarks = true,
                                       .edits_at = [](const Hover&) { return true; },
                                       .begin = begin_landmark,
                                       .move = move_landmark,
                                       .action = landmark_action,
                                       .follow = follow_landmark};
/// The list of landmarks takes it in hand.
constinit const ToolKind template_landmark_tool{.tool = MouseTool::template_landmark,
                                                .name = "Template landmark",
                                                .log_name = "template landmark",
                                                .hint = template_landmark_hint,
                                                .names_landmarks = true,
                                                .begin = begin_template_landmark,
                                                .follow = follow_template_landmark};

}  // namespace homolog
