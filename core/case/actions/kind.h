#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "core/case/document.h"
#include "core/deform/deformer.h"

namespace homolog {

class Fields;

/// The report of an edit, for the interface: shown during a drag and when it is done.
struct EditReport {
  bool stopped_by_guard = false;  ///< the fold guard (or the quality floor) held the gesture back
  double moved_mm = 0;            ///< the grabbed point's way
  std::optional<Vec3> on;         ///< the point of the surface at the gesture's start that the gesture holds
  std::shared_ptr<const VertexScalars> response;  ///< û, 0…1: how far each vertex follows; null where none
  int solves = 0;
  double solver_ms = 0;
  std::string message;  ///< one sentence for the status line; empty where there is nothing to say
};

// The things that an action works on, as they are when it begins, and the one object that it changes.

/// The document. `after` begins as a copy.
struct DocumentEdit {
  const Document& before;
  Document& after;
};

/// One structure. `after` begins as a copy.
struct StructureEdit {
  const Document& document;  ///< before the edit
  const Structure& before;
  Structure& after;

  /// The mesh at the shown frame, before the edit. Only for actions that need one.
  const Shape& shape() const { return *before.shape(document.frame); }
};

/// The mesh of one structure at the shown frame. `after` begins as a copy.
struct ShapeEdit {
  const Document& document;  ///< before the edit
  ShapeView before;
  Shape& after;
  Deformer& deformer;
  Pass pass;
};

/// The role of an action's line in the history.
enum class LineRole {
  step,
  stroke,        ///< a step that moves the mesh by hand
  step_or_look,  ///< a look where the line says `"look":true`, else a step
  note,
  undo,
  redo
};

/// All that the program knows of an action beside its data. Each action has one of these, in the source that is named
/// like its header; `action_kind(action)` gives it.
template <class A>
struct ActionKind {
  const char* key;      ///< the member by which a line is known to be of this action
  const char* example;  ///< a line of it, for docs/case-file.md
  const char* meaning;  ///< its effect in words, for docs/case-file.md
  LineRole role = LineRole::step;
  /// Refused where the structure has no mesh at the shown frame. An action on a shape always is.
  bool needs_mesh = true;
  std::string (*name)(const A&);  ///< a few words for menus: "Undo pull"
  void (*spell)(Fields&, A&);     ///< the members of its line, to read them and to write them
  /// The function that does it; the kind of edit is the scope of the action.
  std::variant<Result<EditReport> (*)(const A&, DocumentEdit&), Result<EditReport> (*)(const A&, StructureEdit&),
               Result<EditReport> (*)(const A&, ShapeEdit&)>
      apply;
};

}  // namespace homolog
