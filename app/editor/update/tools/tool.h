#pragma once

#include <array>
#include <optional>
#include <string>

#include "app/editor/update/controls.h"
#include "core/base/enumerators.h"

namespace homolog {

// A tool of the mouse is a row, a ToolKind: all that the editor knows of it, but for what it remembers while a drag
// goes on (state/drag.h) and the settings that the panels show.

/// A press of the left button: where, and what lies there.
struct Press {
  EditorState& state;
  const InputEvent& event;
  const ControlsContext& context;
  Outbox& out;
  const Hover& hover;

  const Document& document() const { return context.document; }
  std::optional<ShapeView> shape() const { return context.shape(); }
  ViewMap map() const { return view_map(state, context.layout, document(), hover.view); }
  bool in_space() const { return hover.view == ViewKind::space; }
  /// Stops the frames from playing: a drag belongs to the frame that is shown.
  void stay_at_frame() const {
    if (state.look.playing) out.send(PlayFrames{false});
  }
  /// A press that asks for something at once does so when it can be no double click.
  bool hold(HeldClick click) const {
    click.until = event.seconds + double_click_seconds;
    state.pointer.held_click = std::move(click);
    return true;
  }
};

/// A movement of the pointer while a drag goes on.
struct DragStep {
  EditorState& state;
  const InputEvent& event;
  const ControlsContext& context;
  Outbox& out;

  ViewMap map(ViewKind kind) const { return view_map(state, context.layout, context.document, kind); }
  /// The point that the pointer is over in the drag's view; nothing outside it.
  std::optional<Vec3> over(ViewKind kind) const {
    return state.pointer.hover && state.pointer.hover->view == kind ? state.pointer.hover->p_mm : std::nullopt;
  }
};

enum class PointerShape { arrow, hand, move, scale };

/// The marks that are drawn in the views while a tool is in hand. The interface draws it
/// (interface/marks/view_marks.cpp).
enum class ToolMarks {
  none,
  sigma_ring,    ///< the point of the mesh that a press would take hold of, with σ around it
  brush_circle,  ///< the circle that a brush paints
  handles        ///< the placement's handles
};

/// The pointer over what most tools take hold of: the mesh, or a landmark.
PointerShape hand_over_mesh(const EditorState& state);
/// The same for those that take hold of landmarks alone.
PointerShape hand_over_landmarks(const EditorState& state);

/// Whether a press would take hold of the mesh, or of a handle of its placement.
bool edits_mesh_at(const Hover& hover);

/// Everything about a tool of the mouse.
struct ToolKind {
  MouseTool tool;
  const char* name;               ///< its name on the strip
  const char* log_name;           ///< its name in the log
  const char* key = "";           ///< the key that takes it in hand; empty: none
  const char* in_keys = "";       ///< its words in the list of keys
  const char* glyph = "";         ///< its glyph on the strip; empty: the tool is not there
  const char* tip = "";           ///< the button's tip
  bool ends_group = false;        ///< a gap follows on the strip
  bool needs_image = false;       ///< the button waits for an image; else for a mesh
  const char* section = nullptr;  ///< the section of the side panel that it unfolds; null: none

  ToolMarks marks = ToolMarks::none;
  PointerShape (*cursor)(const EditorState& state) = hand_over_mesh;
  /// The status line's words while it is in hand and the case has a mesh.
  std::string (*hint)(const EditorState& state, const Document& shown) = nullptr;

  std::optional<Tool> stroke = {};  ///< the gesture that its drags make; none: they are no strokes
  /// Whether its drags act on what lies under the pointer then, so that this is looked up at every step.
  bool follows_mesh = false;
  /// The names of landmarks stand beside them while it is in hand.
  bool names_landmarks = false;
  /// Whether its drag at a place edits the structure that is worked on, so that a lock refuses it.
  bool (*edits_at)(const Hover& hover) = edits_mesh_at;
  /// Begins what a press asks for: a drag, or a click that is held. False where there is nothing for it.
  bool (*begin)(const Press& press) = nullptr;
  /// The drag goes on; null for a tool that makes none.
  void (*move)(const DragStep& step) = nullptr;
  /// The edit that the drag would make now; none where it edits nothing (yet).
  std::optional<Action> (*action)(const EditorState& state) = [](const EditorState&) -> std::optional<Action> {
    return std::nullopt;
  };
  /// The drag is over, and its edit was made.
  void (*finish)(EditorState& state) = [](EditorState&) {};
  /// The drag is given up, and its preview was taken back.
  void (*cancel)(EditorState& state) = [](EditorState&) {};
  /// Does what follows from an edit that the tool made.
  void (*follow)(EditorState& state, const Action& action, const ControlsContext& context,
                 Outbox& out) = [](EditorState&, const Action&, const ControlsContext&, Outbox&) {};
};

// In the order of MouseTool, which is that of the strip and of the list of keys.
extern const ToolKind pull_tool, grab_tool, slide_tool, relax_tool, place_tool, landmark_tool, stiffness_tool,
    confirm_tool, ruler_tool, contour_tool, template_landmark_tool;
inline constexpr std::array tool_kinds{&pull_tool,
                                       &grab_tool,
                                       &slide_tool,
                                       &relax_tool,
                                       &place_tool,
                                       &landmark_tool,
                                       &stiffness_tool,
                                       &confirm_tool,
                                       &ruler_tool,
                                       &contour_tool,
                                       &template_landmark_tool};
static_assert(tool_kinds.size() == enumerators<MouseTool>(), "a row for each MouseTool, in their order");

/// The row of a tool.
const ToolKind& kind_of(MouseTool tool);
/// The row of the tool that a drag is of; null where a view is moved, or nothing.
const ToolKind* dragging_tool(const EditorState& state);
/// Tools that paint within a circle.
bool is_brush(MouseTool tool);

/// A brush that waited whether its press begins a double click paints now, from that press to a px.
void paint_to(EditorState& state, const ControlsContext& context, double x_px, double y_px, Outbox& out);
/// The dab at the press of a brush that has not begun to paint; none where it covers nothing of the mesh.
std::optional<Action> first_dab(const EditorState& state, const ControlsContext& context);

}  // namespace homolog
