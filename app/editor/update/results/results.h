#pragma once

#include "app/editor/update/editing.h"

namespace homolog {

/// Takes in what the threads did, and moves what moves by itself. `seconds` is the window's clock. True where there is
/// something new to draw.
bool take_results(Editing& editing, double seconds);
/// Waits for what is being opened, written and computed, and takes it in.
void settle(Editing& editing);
/// Seconds until something moves by itself (a cine, a progress bar); nothing where only events change the picture.
std::optional<double> next_move_seconds(const EditorState& state, const Work& work, double now);

/// The stage of the template in the making that is shown; null: the case's mesh is.
std::shared_ptr<const Mesh> shown_making(const EditorState& state, const Work& work);

}  // namespace homolog
