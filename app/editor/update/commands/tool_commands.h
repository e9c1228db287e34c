#pragma once

#include <optional>
#include <string>

#include "app/editor/state/state.h"

namespace homolog {

class Fields;
class Outbox;
struct ControlsContext;

// The tool in hand, and its settings.

/// Place, Landmark and the brushes also bring the section of the panel that they belong to into view.
struct ChooseTool {
  static constexpr const char* key = "choose tool";
  MouseTool tool = MouseTool::pull;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
/// The small, the medium or the large σ; a running stroke takes it at once.
struct ChooseSigma {
  static constexpr const char* key = "choose sigma";
  std::size_t preset = 1;  ///< 0…2
  void spell(Fields& line);
  void run(EditorState& state, const ControlsContext& context, Outbox& out) const;
};
/// Takes the stiffness brush to paint a region; empty: none.
struct BrushRegion {
  static constexpr const char* key = "brush region";
  std::string region;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
/// Takes the Landmark tool: the next click places this one.
struct ChooseLandmark {
  static constexpr const char* key = "choose landmark";
  std::string name;
  std::optional<Vec3> look_at_mm;  ///< its place, if it is placed
  void spell(Fields& line);
  void run(EditorState& state) const;
};
struct SetSnap {
  static constexpr const char* key = "set snap";
  SnapSettings snap;  ///< all but what was learned, which stays
  void spell(Fields& line);
  void run(EditorState& state) const;
};
/// Turns the snapping of strokes on or off, and says so.
struct SnapWithStrokes {
  static constexpr const char* key = "snap with strokes";
  bool on = true;
  void spell(Fields& line);
  void run(EditorState& state) const;
};

/// Escape in the views: it gives a drag up, else removes the ruler, else shows all four views again.
struct Escape {
  static constexpr const char* key = "escape";
  void run(EditorState& state, const ControlsContext& context, Outbox& out) const;
};

}  // namespace homolog
