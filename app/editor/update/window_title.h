#pragma once

#include <string>

#include "app/editor/update/editing.h"

namespace homolog {

/// The name of the case on the screen: its file's, else its image's.
std::string case_title(const Snapshot& snapshot);
/// The name of the study; "No study" without one.
std::string study_title(const ModelsState& state);

/// For the frame that the system draws around the window: what is open in the mode that is shown, whether edits of it
/// are not saved under a name yet, and what runs. "ct.nii.gz, not saved, fitting – Homolog".
std::string window_title(const EditorState& state, const Snapshot& snapshot, const Work& work);

}  // namespace homolog
