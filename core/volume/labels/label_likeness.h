#pragma once

#include "core/volume/volume.h"

namespace homolog {

/// How sure it is that a volume holds labels: all values are whole numbers from 0 on, and neighbours mostly have the
/// same one; and with that, values are few and small.
enum class LabelLikeness { none, flat_parts, few_small_values };
LabelLikeness label_likeness(const Volume& volume);
bool holds_labels(const Volume& volume);
/// Whether a label map has the same voxels in space as an image. No values are compared, only the geometry and the
/// number of frames.
bool on_same_voxels(const Volume& volume, const Volume& image);

}  // namespace homolog
