#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/volume/dicom/dicom_arrangement.h"
#include "core/volume/volume_io.h"

namespace homolog {

/// The old slices next to slice k of the grid that they became; where it is one of them, that one alone.
struct SliceNeighbours {
  std::size_t below = 0, above = 0;
  double share = 0;            ///< of the upper one
  double column = 0, row = 0;  ///< of the first voxel there: slices that are shifted are followed along their way
};
SliceNeighbours neighbours_of(std::span<const OldSlice> slices, int k);

/// Makes a rectangular grid of slices that are no even stack [DicomArrangement::uneven]: `volume` has their voxels, one
/// slice behind another, and becomes 32-bit floats on the new grid. Its slices lie across the normal, from the first of
/// the old ones on, as far apart as the old ones mostly are (the median); pixels keep their size and directions, and
/// the grid reaches over all that the slices are shifted by. Values are interpolated linearly between the two slices
/// next to a voxel; where there are none they are the image's lowest. Errors: memory; cancelled.
Result<ResampledSlices> resample_slices(const std::filesystem::path& path, const DicomArrangement& arrangement,
                                        Volume& volume, Progress* progress);

/// The warning that says what was done.
std::string resampled_sentence(const std::filesystem::path& path, const ResampledSlices& done);

}  // namespace homolog
