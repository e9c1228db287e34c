#pragma once

#include <optional>

#include "app/editor/state/state.h"
#include "app/editor/update/commands/logged.h"

namespace homolog {

class Fields;
class Outbox;
struct ControlsContext;
struct Editing;

// The choice of what is seen, and from where.

/// Goes through the slices of a view; the 3D view has none.
struct ScrollSlices {
  static constexpr const char* key = "scroll slices";
  ViewKind view = ViewKind::axial;
  double steps = 1;
  void spell(Fields& line);
  void run(EditorState& state, const ControlsContext& context, Outbox& out) const;
};
/// Unfolds or folds the section of that title, in the panel of either mode.
struct OpenSection {
  static constexpr const char* key = "open section";
  std::string section;
  bool open = true;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
struct ShowAll {
  static constexpr const char* key = "fit views";
  void run(EditorState& state, const ControlsContext& context, Outbox& out) const;
};
/// The range of grey values.
struct SetWindow {
  static constexpr const char* key = "set window";
  double low = 0, high = 1;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
/// Slices along the image's own axes.
struct ShowOwnPlanes {
  static constexpr const char* key = "show own planes";
  bool own = true;
  void spell(Fields& line);
  void run(EditorState& state, const ControlsContext& context, Outbox& out) const;
};
struct ChooseColouring {
  static constexpr const char* key = "choose colouring";
  Colouring colouring = Colouring::vertex_hue;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
/// Shows a frame while its slider is dragged; ShowFrame commits it.
struct SeekFrame {
  static constexpr const char* key = "seek frame";
  static constexpr Logged logged = Logged::never;  ///< ShowFrame is
  int frame = 0;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
/// Brings the cross-hair and the 3D view to a point, LPS mm.
struct LookAt {
  static constexpr const char* key = "look at";
  Vec3 point_mm = Vec3::Zero();
  void spell(Fields& line);
  void run(EditorState& state) const;
};
/// Goes to the next (or the last) finding of a kind, or of all kinds; see findings_shown.
struct ShowFinding {
  static constexpr const char* key = "show finding";
  std::optional<FindingKind> kind;
  bool back = false;
  void spell(Fields& line);
  void run(Editing& editing) const;
};
/// The guide to the first case: so many pulls on, or back.
struct MoveInGuide {
  static constexpr const char* key = "move in guide";
  int steps = 1;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
/// Shows the guide from its beginning, with the first case where that is not open; or closes it.
struct ShowGuide {
  static constexpr const char* key = "show guide";
  bool shown = true;
  void spell(Fields& line);
  void run(Editing& editing) const;
};

}  // namespace homolog
