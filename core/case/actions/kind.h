#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/case/document.h"
#include "core/deform/deformer.h"

namespace homolog {

class Fields;

/// What an edit did, for the interface: shown during a drag and when it is done.
struct EditReport {
  bool stopped_by_guard = false;  ///< the fold guard (or the quality floor) held the gesture back
  double moved_mm = 0;            ///< of the grabbed point
  std::optional<Vec3> on;         ///< the point of the surface at the gesture's start that the gesture holds
  std::shared_ptr<const VertexScalars> response;  ///< û, 0…1: how far each vertex follows; null where none
  int solves = 0;
  double solver_ms = 0;
  std::string message;  ///< one sentence for the status line; empty where there is nothing to say
};

/// What an action works on. It changes `after`, which begins as a copy of `before`.
struct Edit {
  const Document& before;
  Document after;
  Deformer& deformer;
  Pass pass;

  /// The shown frame's shape after the edit.
  Shape& shape() { return after.shapes.at(after.frame); }
};

/// What the line of an action is to the history.
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
  const char* meaning;  ///< what it does, for docs/case-file.md
  LineRole role = LineRole::step;
  bool needs_mesh = true;         ///< refused where the shown frame has no mesh
  std::string (*name)(const A&);  ///< a few words for menus: "Undo pull"
  void (*spell)(Fields&, A&);     ///< the members of its line, to read them and to write them
  Result<EditReport> (*apply)(const A&, Edit&);
};

}  // namespace homolog
