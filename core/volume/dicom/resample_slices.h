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
  double share = 0;            ///< the upper one's share
  double column = 0, row = 0;  ///< the first voxel there: slices that are shifted are followed along their way
};
SliceNeighbours neighbours_of(std::span<const OldSlice> slices, int k);

/// The old slice nearest to slice k of the grid, from which it takes what cannot be interpolated: labels, contours.
struct TakenSlice {
  std::size_t old = 0;
  double column = 0, row = 0;  ///< its first voxel, moved sideways to slice k
  double off = 0;              ///< how far it lies from slice k, in slices
};
TakenSlice taken_by(std::span<const OldSlice> slices, int k);

/// Puts labels or shares that lie on the slices of a series onto the grid that they were resampled to: each slice has
/// the voxels of the old one nearest to it, moved sideways to the nearest pixel; what lies beyond them is 0. Errors:
/// memory.
Result<void> take_slices(const std::filesystem::path& path, const ResampledSlices& done, const VolumeGeometry& grid,
                         Volume& volume);

/// The warning that something that was drawn on such slices lies on the grid: `what` ("frame", "contours").
std::string taken_sentence(const std::filesystem::path& path, const std::string& what, const ResampledSlices& done,
                           const VolumeGeometry& grid);

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
