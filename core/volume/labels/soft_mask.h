#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "core/base/result.h"
#include "core/volume/labels/label_boxes.h"
#include "core/volume/volume.h"

namespace homolog {

/// Whether a frame is a soft mask as it stands: real values from 0 to 1, not all of them 0 or 1. Each is then the share
/// of its voxel that one structure has, or the probability of it.
bool is_soft(const Volume& mask, int frame);

/// The level of a soft mask's surface if none is asked for.
inline constexpr double usual_level = 0.5;

/// Takes the frame for a soft mask and moves its values so that the surface at `level` lies at 0.5: label 1 is what is
/// above it, and `Volume::soft` is set. `level` up to 1: of values from 0 to 1; above 1: of values from 0 to 255.
/// False, and nothing changed, for a mask of 0 and 1 alone. Errors: values beyond those.
Result<bool> make_soft(Volume& mask, int frame, double level);

/// One of several soft masks that became the labels of a map, as those of a folder do.
struct SoftSegment {
  int value = 0;
  std::size_t layer = 0;
  Volume shares;  ///< a soft mask: of its grid the part around the label
};

/// The soft mask of a frame that make_soft made soft, as the label `value` of a layer; none where nothing is above its
/// level.
std::optional<SoftSegment> soft_segment(const Volume& soft, int value, std::size_t layer);

/// The one whose label this is: none where there is none, or where the label has other voxels by now. `box`: all of its
/// voxels in `map`, which is its layer.
const SoftSegment* soft_of_label(std::span<const SoftSegment> all, const Volume& map, const VoxelBox& box, int value,
                                 std::size_t layer);

/// The soft mask on the whole grid of its label, or on a part of that.
Volume soft_on_grid(const SoftSegment& soft, const Volume& like);

}  // namespace homolog
