#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/editor/update/commands/logged.h"
#include "app/editor/update/commands/looks/setting.h"
#include "app/editor/update/results/set_fit.h"

namespace homolog {

class Fields;
class Outbox;
struct Document;
struct Editing;

// The structures of a case: which one is worked on, and how the others are shown.

/// Works on another structure of the case.
struct ChooseStructure {
  static constexpr const char* key = "choose structure";
  std::string id;  ///< empty: the first
  void spell(Fields& line);
  void run(Editing& editing) const;
};
/// A click on a row of the list: works on that structure, and brings it into view. With Ctrl or Shift it chooses
/// several rows instead.
struct ClickStructure {
  static constexpr const char* key = "click structure";
  std::string id;
  bool ctrl = false, shift = false;
  void spell(Fields& line);
  void run(Editing& editing) const;
};
/// Works on the next structure of the list that is shown, or the last one before.
struct NextStructure {
  static constexpr const char* key = "next structure";
  bool back = false;
  bool doubtful = false;  ///< the next one that somebody has to look at
  void spell(Fields& line);
  void run(Editing& editing) const;
};
/// A person says that the structure that is worked on is right: it is doubtful no more. Goes on to the next doubtful
/// one.
struct AcceptStructure {
  static constexpr const char* key = "accept structure";
  void run(Editing& editing) const;
};
/// Moves the structure that is worked on out of its neighbours. Undone together with the edit before it.
struct KeepApart {
  static constexpr const char* key = "keep apart";
  double gap_mm = 0;  ///< the gap that stays between them
  void spell(Fields& line);
  void run(Editing& editing) const;
};
/// Brings vertices that structures share with the one that is worked on to where it has them; to those of a locked one
/// it goes itself. Undone together with the edit before it.
struct FollowShared {
  static constexpr const char* key = "follow shared vertices";
  void run(Editing& editing) const;
};
/// Sends FollowShared after an edit of a structure (`of`: its id) that shares vertices.
void let_shared_follow(const Document& document, std::string_view of, Outbox& out);
/// Gives the structure that is worked on the shape back that it had before a repair; one that was missing goes.
struct TakeBackRepair {
  static constexpr const char* key = "take back repair";
  void run(Editing& editing) const;
};
/// Gives the structure that is worked on, and all at its level of the spine and below, the names of so many levels
/// farther down (above 0) or up. One step.
struct RenameLevels {
  static constexpr const char* key = "rename levels";
  int steps = 1;
  void spell(Fields& line);
  void run(Editing& editing) const;
};
/// Opens or closes eyes.
struct ShowStructures {
  static constexpr const char* key = "show structures";
  std::vector<std::string> ids;
  bool shown = true;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
/// Hides all others.
struct ShowOnlyStructures {
  static constexpr const char* key = "show only structures";
  std::vector<std::string> ids;
  void spell(Fields& line);
  void run(Editing& editing) const;
};
struct LockStructures {
  static constexpr const char* key = "lock structures";
  std::vector<std::string> ids;
  bool locked = true;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
/// How far structures are seen through in 3D.
struct SetStructureOpacity {
  static constexpr const char* key = "set structure opacity";
  std::vector<std::string> ids;
  double opacity = 1;  ///< 0…1
  void spell(Fields& line);
  void run(EditorState& state) const;
};
/// Shuts the eyes of these labels of the map, and opens those of all others.
struct HideLabels {
  static constexpr const char* key = "hide labels";
  std::vector<int> labels;
  void spell(Fields& line);
  void run(EditorState& state) const;
};
/// Reads a template set, of a file or built in, to be fitted to the label map.
using ChooseSet = EditingCallLogged<Logged::when_done, "choose set", "source", choose_set>;
/// Fits the chosen set to the label map that is shown, or to the map that its repair proposes. Its structures come into
/// the case as one step.
using FitSet = EditingCallLogged<Logged::when_done, "fit set", "repair", start_set_fit>;
/// Gives up the fit of a set, which is not logged then.
void cancel_set_fit(Editing& editing);
using CancelSetFit = PlainEditingCallLogged<Logged::never, "cancel set fit", cancel_set_fit>;
/// A structure that the list does not show any more is chosen no more either.
struct FilterStructures {
  static constexpr const char* key = "filter structures";
  std::string text;
  void spell(Fields& line);
  void run(Editing& editing) const;
};
using SortStructures =
    Setting<"sort structures", "worst_first", &EditorState::look, &Look::structures, &StructureLooks::worst_first>;
using KeepApartAfterStrokes =
    Setting<"keep apart after strokes", "on", &EditorState::automatic, &Automatic::keep_apart>;
using SetStructureGap = Setting<"set structure gap", "gap_mm", &EditorState::automatic, &Automatic::gap_mm>;
/// 0…1.
using SetOthersOpacity =
    Setting<"set others opacity", "opacity", &EditorState::look, &Look::structures, &StructureLooks::others_opacity>;
using ShowAsRead =
    Setting<"show as read", "shown", &EditorState::look, &Look::structures, &StructureLooks::as_read_shown>;

}  // namespace homolog
