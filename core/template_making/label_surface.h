#pragma once

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/mesh/topology.h"
#include "core/volume/volume.h"

namespace homolog {

/// The smooth surface of a label (or of every_label) in a frame, as it is shown: every part of it, LPS mm, outward
/// oriented. It lies within about a voxel of the label's faces, has no stairs where slices are thick, and about as many
/// vertices for a small organ as for a large one. Errors: the label does not occur; it was cancelled.
Result<Mesh> label_surface(const Volume& labels, int label, int frame, Progress* progress = nullptr);

}  // namespace homolog
