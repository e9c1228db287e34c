#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/volume/dicom/dicom_arrangement.h"

namespace homolog {

/// Orders the planes of each place, which are the frames of a cine, by the clocks that all of them have, else by their
/// numbers. Errors: planes of one place that differ in what is no time (image types, b-values, acquisitions …), or in
/// nothing. `warnings`: an order that was assumed.
Result<void> order_frames(const std::filesystem::path& path, const std::vector<DicomHeader>& headers,
                          std::vector<std::vector<DicomPlaneSource>>& places, std::vector<std::string>& warnings);

/// The time between the first two frames at the first of the ordered places; 0 where no clock says.
double seconds_between_frames(const std::vector<DicomHeader>& headers,
                              const std::vector<std::vector<DicomPlaneSource>>& places);

}  // namespace homolog
