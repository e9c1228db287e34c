#pragma once

#include <NrrdIO.h>  // which has no guard of its own: include this header instead

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/volume/nrrd_header.h"
#include "core/volume/volume.h"

namespace homolog {

/// Which axes of an NRRD array are the patient's, and which one, if any, holds frames.
struct NrrdAxes {
  std::vector<unsigned> space;
  std::optional<unsigned> frames;
};

/// Axes with a direction in space, or else the first three that are none of values. One of the others may hold frames:
/// of time, a list, or of a kind that is not said. Errors: vectors, colours, five dimensions.
Result<NrrdAxes> find_axes(const Nrrd& nrrd, const std::filesystem::path& path);

/// The grid in mm (LPS), by its space or else by spacings and axis mins, in the units that the header gives.
/// `warnings`: what it does not say, and units that nobody knows.
Result<VolumeGeometry> grid_of(const Nrrd& nrrd, const NrrdHeader& header, const NrrdAxes& axes,
                               const std::filesystem::path& path, std::vector<std::string>& warnings);

/// The time between the frames along an axis; 0 where it is not said.
double seconds_between_frames(const Nrrd& nrrd, const NrrdHeader& header, unsigned axis);

}  // namespace homolog
