#pragma once

#include <optional>
#include <string>

#include "app/editor/update/commands/file_commands.h"
#include "app/editor/update/commands/looks/setting.h"
#include "app/editor/update/results/optimisation.h"

namespace homolog {

// Commands to the gallery of the Models mode and its model: what they show, from where, and which mode.

struct TurnGallery {
  static constexpr const char* key = "turn gallery";
  double right_px = 0, down_px = 0;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
struct PanGallery {
  static constexpr const char* key = "pan gallery";
  double right_px = 0, down_px = 0, side_px = 1;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
/// Marks a vertex in all shapes; none: unmarks.
struct PinVertex {
  static constexpr const char* key = "pin vertex";
  std::optional<GalleryVertex> place;
  bool focus = false;  ///< every cell looks at it
  void spell(Fields& line);
  void run(EditorState& state) const;
};

// The model's shape that is shown.

/// The coefficients of the selected case.
struct ShowSelectedShape {
  static constexpr const char* key = "show selected shape";
  void run(EditorState& state) const;
};
/// A coefficient, in standard deviations.
struct SetMode {
  static constexpr const char* key = "set mode";
  std::size_t mode = 0;
  double deviations = 0;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
struct AnimateMode {
  static constexpr const char* key = "animate mode";
  std::optional<std::size_t> mode;  ///< none: it stops
  void spell(Fields& line);
  void run(EditorState& state) const;
};
struct ShowDifference {
  static constexpr const char* key = "show difference";
  bool shown = true;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
struct CompareGroup {
  static constexpr const char* key = "compare group";
  std::size_t which = 0;  ///< 0: from, 1: to
  std::string group;
  void spell(Fields& line);
  void run(EditorState& state) const;
};

// Commands of the section Optimise of the Models mode.

/// Slides the vertices of the study's shapes along their surfaces.
using StartOptimisation = PlainEditingCallLogged<Logged::when_done, "start optimisation", start_optimisation>;
struct CancelOptimisation {
  static constexpr const char* key = "cancel optimisation";
  static constexpr bool cancels = true;
  static constexpr Logged logged = Logged::never;
  void run(EditorState& state) const;
};

}  // namespace homolog
