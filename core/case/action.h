#pragma once

#include <string>
#include <utility>
#include <variant>

#include "core/case/actions/confirm.h"
#include "core/case/actions/contours.h"
#include "core/case/actions/frames.h"
#include "core/case/actions/history_marks.h"
#include "core/case/actions/landmarks.h"
#include "core/case/actions/mirror.h"
#include "core/case/actions/placement.h"
#include "core/case/actions/points.h"
#include "core/case/actions/regions.h"
#include "core/case/actions/settings.h"
#include "core/case/actions/stiffness.h"
#include "core/case/actions/stroke.h"
#include "core/case/actions/structures.h"

namespace homolog {

/// Every change that a user (or a case file) can make: the list of all actions. Each is written in core/case/actions/:
/// its data, what it does, its name for Undo, its line of the case file and its row in docs/case-file.md. The first one
/// whose key a line has reads the line.
using Action =
    std::variant<Stroke, SetPoints, MovePoints, SetPlacement, PaintStiffness, SmoothStiffness, PaintRegion, FillRegion,
                 SetRegion, RenameRegion, RemoveRegion, SetStiffnessFactors, SetTemplateLandmark, SetStiffnessBase,
                 Confirm, SetScheme, SetEvenSpacing, PlaceLandmark, SetLandmarkPull, MirrorTemplate, SetFrame,
                 StartFrameFrom, SetStructure, RemoveStructure, SetContours, RemoveContours, Note, Undo, Redo>;

/// Calls `visit(action_kind(A))` for every action A, in the order of the list.
template <class Visit>
void for_each_action_kind(const Visit& visit) {
  [&]<std::size_t... i>(std::index_sequence<i...>) {
    (visit(action_kind(std::variant_alternative_t<i, Action>{})), ...);
  }
  (std::make_index_sequence<std::variant_size_v<Action>>{});
}

/// An action as the journal holds it.
struct EditStep {
  Action action;
  std::string of{};  ///< the id of the structure that it works on; empty: the first [Document::structure]
  /// Undone and redone together with the one before it: the further touches of a brush stroke, the points of a list.
  bool joined = false;
};

struct Updated {
  Document document;
  EditReport report;
};

/// The one function that edits a case: the editor, the case file, the command line and the tests all come here.
/// `of`: see EditStep. `deformer` is that of the structure: it caches factorisations and the running gesture. Undo and
/// Redo belong to EditSession and are refused here. Errors: a structure that there is not, an edit that needs a shape
/// where there is none, values out of range.
Result<Updated> update(const Document& document, const std::string& of, const Action& action, Deformer& deformer,
                       Pass pass);

/// Whether an action works on one structure (or its mesh), else on the whole case.
bool works_on_structure(const Action& action);

/// A few words for menus: "Undo pull".
std::string action_name(const Action& action);

}  // namespace homolog
