#pragma once

#include <string>
#include <vector>

#include "app/editor/state/state.h"
#include "app/editor/update/commands/logged.h"
#include "app/editor/update/commands/looks/setting.h"
#include "app/editor/update/results/imports.h"

namespace homolog {

class Fields;
struct Editing;

// Contours: curves that were drawn of the organ.

/// Reads a file of contours. One structure comes into the case at once; of several, those that are called like a
/// structure of the case. Else the panel offers them to choose from.
using OpenContours = EditingCallLogged<Logged::when_done, "open contours", "path", import_contours>;
/// Adds a structure of the file that is offered, by its number there, to the structure that is worked on.
struct AddContours {
  static constexpr const char* key = "add contours";
  int number = 0;
  void spell(Fields& line);
  void run(Editing& editing) const;
};
/// Opens or closes eyes.
struct ShowContours {
  static constexpr const char* key = "show contours";
  std::vector<std::string> ids;
  bool shown = true;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
/// Fits the mesh to the contours of the shown frame.
struct FitContours {
  static constexpr const char* key = "fit contours";
  /// It follows a curve that was drawn: undone together with it, and strokes before it are kept.
  bool joined = false;
  void spell(Fields& line);
  void run(Editing& editing) const;
};
struct CancelContourFit {
  static constexpr const char* key = "cancel contour fit";
  static constexpr bool cancels = true;
  static constexpr Logged logged = Logged::when_done;  ///< nothing is logged where none ran
  void run(Editing& editing) const;
};

}  // namespace homolog
