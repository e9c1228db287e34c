#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/volume/volume_io.h"

namespace homolog {

// What the verbs share that write a label map on the grid of an image: convert, label-map.

/// Whether a file of that name is one of DICOM.
bool is_dicom_name(const std::filesystem::path& path);
/// Writes a label map by the ending of its name; one of DICOM refers to a series. Gives warnings.
Result<std::vector<std::string>> write_labels(const VolumeRead& map, const std::filesystem::path& out,
                                              const std::filesystem::path& series, Progress& progress,
                                              const std::string& record);
/// The volume whose grid a label map gets.
Result<VolumeRead> read_like(const std::filesystem::path& path, bool resample, Progress& progress);

}  // namespace homolog
