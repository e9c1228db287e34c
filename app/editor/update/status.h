#pragma once

#include <string>

#include "app/editor/state/state.h"
#include "core/session/session_thread.h"

namespace homolog {

// The sentence at the window's foot is made of the state alone, so that it never says what is no longer so.

struct Status {
  std::string text;
  bool warns = false;  ///< the running gesture was stopped before the surface would fold, or a frame is in doubt
};

/// The words of the last edit or of the running gesture, for as long as that is news; else what the hand can do now.
/// `making_shown`: a template in the making stands in for the case's mesh.
Status status_of(const EditorState& state, const Snapshot& snapshot, const Document& shown, bool making_shown = false);

/// Why a control that needs a mesh is disabled; empty where there is one.
std::string why_no_mesh(const EditorState& state, const Document& shown);

}  // namespace homolog
