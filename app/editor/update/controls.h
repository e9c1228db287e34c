#pragma once

#include <variant>

#include "app/editor/picking/picking.h"
#include "app/editor/picking/shown_mesh.h"
#include "app/editor/state/key_codes.h"
#include "app/editor/state/state.h"
#include "app/editor/update/commands.h"

namespace homolog {

struct MouseMove {};
struct MousePress {
  MouseButton button = MouseButton::left;
};
struct MouseRelease {
  MouseButton button = MouseButton::left;
};
struct Wheel {
  double steps = 0;  ///< up is positive
};
struct KeyPress {
  int key = 0;
};

/// One thing the user did, with where the pointer was and what was held, taken from the window system at once.
struct InputEvent {
  std::variant<MouseMove, MousePress, MouseRelease, Wheel, KeyPress> what;
  double x_px = 0, y_px = 0;
  bool shift = false, ctrl = false, alt = false;
  double seconds = 0;       ///< a clock, for double clicks
  bool over_panel = false;  ///< the interface takes the pointer: only keys and running drags are for the views
};

/// The state that the controls look at.
struct ControlsContext {
  const Layout& layout;
  const Document& document;  ///< the document as shown
  ShownMesh& mesh;           ///< the document's mesh
  bool can_undo = false, can_redo = false;
  std::filesystem::path file = {};  ///< the case's file; empty where it has none
  bool fits = false;                ///< a fit, a refinement or a propagation goes on
  std::string_view structure = {};  ///< the structure that is worked on; empty: the first

  /// The mesh that the tools act on.
  std::optional<ShapeView> shape() const { return document.view(structure); }
};

/// Does what an event asks for: changes the state, and sends edits and other commands.
void handle_event(EditorState& state, const InputEvent& event, const ControlsContext& context, Outbox& out);

/// How the view that is `kind` maps mm to px now.
ViewMap view_map(const EditorState& state, const Layout& layout, const Document& document, ViewKind kind);
/// The point of the mesh that lies under a px: in a slice the nearest point of the outline, at most `reach_mm` away; in
/// space what is seen there.
std::optional<Vec3> mesh_at(const EditorState& state, const ControlsContext& context, const Pointing& at,
                            double reach_mm);
/// Pointer and what it is over, anew: after a scroll, or when the mesh moved beneath it.
void update_hover(EditorState& state, const ControlsContext& context, double x_px, double y_px);

// Parts of handle_event.
void press_key(const EditorState& state, const InputEvent& event, int key, const ControlsContext& context, Outbox& out);
void start_drag(EditorState& state, const InputEvent& event, MouseButton button, const ControlsContext& context,
                Outbox& out);
void move_drag(EditorState& state, const InputEvent& event, const ControlsContext& context, Outbox& out);
void finish_drag(EditorState& state, const InputEvent& event, const ControlsContext& context, Outbox& out);
void cancel_drag(EditorState& state, Outbox& out);

/// Two presses within this time, and this near to each other, are a double click.
inline constexpr double double_click_seconds = 0.35, double_click_px = 4;
/// Whether an event comes so soon and so near after the last press that both may be one click.
bool near_last_press(const EditorState& state, const InputEvent& event);
/// Does what a click asked for; nothing where none is held.
void do_held_click(EditorState& state, const ControlsContext& context, Outbox& out);
/// The same once no press can make it a double click; and a brush that is held still begins to paint. `seconds` is the
/// clock of the events.
void settle_click(EditorState& state, double seconds, const ControlsContext& context, Outbox& out);

/// One stamp of the stiffness or the confirm brush.
std::optional<Action> brush_action(const EditorState& state, const Document& document, const Vec3& at);
/// The edit that the drag would make now: previewed while it goes on, committed when it ends. Nothing if it edits
/// nothing (yet).
std::optional<Action> drag_action(const EditorState& state);

}  // namespace homolog
