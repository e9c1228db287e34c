#pragma once

#include <optional>
#include <string>

#include "app/editor/state/state.h"
#include "app/editor/update/commands/logged.h"
#include "app/editor/update/commands/looks/setting.h"
#include "core/assist/assist.h"
#include "core/case/action.h"

namespace homolog {

class Fields;
struct Editing;

// Edits of the case.

/// Shows what an action would give; nullopt ends the preview.
struct PreviewEdit {
  static constexpr const char* key = "preview";
  static constexpr Logged logged = Logged::never;
  std::optional<Action> action;
  void spell(Fields& line);
  void run(Editing& editing) const;
};
struct ApplyEdit {
  static constexpr const char* key = "edit";
  Action action;
  bool joined = false;  ///< undone together with the edit before it
  void spell(Fields& line);
  void run(Editing& editing) const;
};
/// Takes back so many steps, or does them again where it is above 0.
struct GoInHistory {
  static constexpr const char* key = "go in history";
  int steps = 0;
  void spell(Fields& line);
  void run(Editing& editing) const;
};
/// Snaps the mesh, or a part of it, to the image, as the settings say.
struct SnapMesh {
  static constexpr const char* key = "snap";
  std::optional<SnapArea> region;
  bool joined = false;  ///< undone together with the edit before it
  void spell(Fields& line);
  void run(Editing& editing) const;
};
struct CancelSnap {
  static constexpr const char* key = "cancel snap";
  static constexpr bool cancels = true;
  static constexpr Logged logged = Logged::when_done;  ///< nothing is logged where none ran
  void run(Editing& editing) const;
};
/// Fits the shown frame's template to the label map that is shown.
struct StartFit {
  static constexpr const char* key = "fit";
  static constexpr Logged logged = Logged::when_done;
  FitSettings settings;
  void spell(Fields& line);
  void run(Editing& editing) const;
};
/// Moves vertices along the mesh's own surface; see refine.
struct RefineAlongSurface {
  static constexpr const char* key = "refine";
  static constexpr Logged logged = Logged::when_done;
  void run(Editing& editing) const;
};
/// Gives up a fit or a refinement; neither is logged then.
void cancel_fit(Editing& editing);
using CancelFit = PlainEditingCallLogged<Logged::never, "cancel fit", cancel_fit>;
/// Blends what the study's model expects into the shape, 0…1: now and after every stroke; as a preview, or as an edit.
struct BlendModel {
  static constexpr const char* key = "blend model";
  double strength = 0;
  bool commit = false;
  void spell(Fields& line);
  void run(Editing& editing) const;
};
/// Lets the study's model complete what the edit before it left open. Undone together with that edit.
struct CompleteByModel {
  static constexpr const char* key = "complete by model";
  void run(Editing& editing) const;
};
/// Gives up whatever fits go on: CancelFit, CancelSetFit and CancelPropagation in one, for the keys.
struct CancelFits {
  static constexpr const char* key = "cancel fits";
  static constexpr bool cancels = true;
  static constexpr Logged logged = Logged::never;
  void run(Editing& editing) const;
};
/// Carries the meshes of the frames that a person made through the cine; see propagate_document.
struct PropagateFrames {
  static constexpr const char* key = "propagate";
  static constexpr Logged logged = Logged::when_done;
  void run(Editing& editing) const;
};
/// Gives up a propagation, which is not logged then.
void cancel_propagation(Editing& editing);
using CancelPropagation = PlainEditingCallLogged<Logged::never, "cancel propagation", cancel_propagation>;
/// Commits the frame that a slider went to.
struct ShowFrame {
  static constexpr const char* key = "show frame";
  int frame = 0;
  void spell(Fields& line);
  void run(Editing& editing) const;
};
/// Plays a cine, or stops and commits the frame that is shown.
struct PlayFrames {
  static constexpr const char* key = "play frames";
  static constexpr Logged logged = Logged::never;  ///< the frame that is committed is
  bool play = true;
  void spell(Fields& line);
  void run(Editing& editing) const;
};

}  // namespace homolog
