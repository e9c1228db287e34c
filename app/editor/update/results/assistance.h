#pragma once

#include <vector>

#include "app/editor/update/editing.h"

namespace homolog {

// The automatic steps on the open case: the fit to a label, the snap of strokes, the help of the study's model.

/// The area that a stroke moves: its falloff, spread by the stiffness.
SnapArea snap_region(const ShapeView& shown, const Stroke& stroke);

/// The computations that carry on from an edit while it is previewed.
std::vector<Compute> assistance(const Editing& editing, const Action& action);

/// Shows how far the fit (or refinement) is, and takes it in when it is done; gives it up where the case was edited
/// meanwhile.
void update_fit(Editing& editing);

/// Takes in what a fit to contours came to.
void update_contour_fit(Editing& editing);
/// Takes in what a propagation through the cine found; gives it up where the case was edited meanwhile.
void update_propagation(Editing& editing);

/// Shows, or commits, the shape with as much of the study's model in it; once that is computed, where it is not yet.
void blend_model(Editing& editing, const BlendModel& command);
void update_model_help(Editing& editing);
/// Learns what the boundary looks like from the study's cases that are done, where snaps are to go by that.
void update_learning(Editing& editing);
/// Takes in what a snap found; true where there is something new to draw.
bool show_snap(Editing& editing);

}  // namespace homolog
