#pragma once

#include <filesystem>
#include <optional>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/volume/contours.h"
#include "core/volume/volume_io.h"

namespace homolog {

/// The closed contours as labels on the grid of an image: a voxel belongs to a structure where its centre lies within
/// an odd number of the structure's contours of its slice, so that holes stay holes, whether they are drawn as keyholes
/// or by exclusive or; and where a contour goes through its centre, also one around a hole. Slices without contours
/// stay empty. If the slices of an image were `resampled`, each has the contours of the old one nearest to it, moved
/// sideways as its pixels were. A label is the number of its structure; structures that overlap lie in layers. `path`
/// and `image_path` are named in sentences. `warnings` of the result: structures without an inside; contours off the
/// slices of the grid, which are left out; contours that leave the image; contours within one another that are not said
/// to be holes; contours that refer to the image of another slice than the one they lie on; structures of which
/// most planes leave slices between them out. Errors: another frame of
/// reference; no closed contour at all, or none on a slice; cancelled.
Result<VolumeRead> labels_of_contours(const std::filesystem::path& path, const Contours& contours,
                                      const std::filesystem::path& image_path, const Volume& image,
                                      Progress* progress = nullptr,
                                      const std::optional<ResampledSlices>& resampled = {});

}  // namespace homolog
