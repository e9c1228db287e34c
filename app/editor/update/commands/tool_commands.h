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
/// Changes the chosen one.
struct SetSigma {
  static constexpr const char* key = "set sigma";
  double sigma_mm = 10;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
struct SetRelaxStrength {
  static constexpr const char* key = "set relax strength";
  double strength = 0.5;  ///< 0…1
  void spell(Fields& line);
  void run(EditorState& state) const;
};
/// Whether a stroke also moves sheets that lie near.
struct MoveThroughSpace {
  static constexpr const char* key = "move through space";
  bool through = true;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
struct SetBrush {
  static constexpr const char* key = "set brush";
  BrushSettings brush;
  void spell(Fields& line);
  void run(EditorState& state) const;
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
  std::optional<Vec3> look_at_mm;  ///< where it lies, if it is placed
  void spell(Fields& line);
  void run(EditorState& state) const;
};
/// The name that the next click gives a point of the template.
struct NameTemplateLandmark {
  static constexpr const char* key = "name template landmark";
  std::string name;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
/// The name of a new region, while it is typed.
struct TypeRegion {
  static constexpr const char* key = "type region";
  std::string name;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
/// The new name of a region while it is typed; none: the field closes.
struct NameRegion {
  static constexpr const char* key = "name region";
  std::optional<RegionNaming> naming;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
/// A number of the case while it is changed in the panel; none: it was let go.
struct ChangeNumber {
  static constexpr const char* key = "change number";
  std::optional<PanelEdit> number;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
struct SetSnap {
  static constexpr const char* key = "set snap";
  SnapSettings snap;  ///< what was learned stays
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
struct SetFit {
  static constexpr const char* key = "set fit";
  FitSettings fit;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
struct SetTemplate {
  static constexpr const char* key = "set template";
  TemplateSettings settings;
  void spell(Fields& line);
  void run(EditorState& state) const;
};

/// What Escape does in the views: gives a drag up, else removes the ruler, else shows all four views again.
struct Escape {
  static constexpr const char* key = "escape";
  void run(EditorState& state, const ControlsContext& context, Outbox& out) const;
};

}  // namespace homolog
