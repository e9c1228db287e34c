#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/volume/volume_io.h"

namespace homolog {

/// Writes a label map as a DICOM segmentation [DICOM PS3.3, A.51] that refers to the images it lies on: `series`, a
/// folder or a file, of several series in it that of `series_uid`. It is a binary one, and of soft masks [soft_mask.h]
/// a fractional one, each layer a segment. Patient, study and space are those of the series. The map may have other
/// axes than the series and be a part of it, but its voxels must be voxels of the series. If the series was resampled
/// [VolumeRead::resampled], the map's grid is taken as it is: its frames have places of their own and refer to the
/// series, not to single images. Slices without voxels have no frames. The same map and series give the same bytes, and
/// others another UID. Gives warnings: labels that are numbered anew, since the standard counts segments from 1; shares
/// that were rounded; what of the patient and the study cannot be read. Errors: no series of images; voxels that lie
/// elsewhere; no label; an element longer than DICOM allows; those of write_whole_file; cancelled.
Result<std::vector<std::string>> write_dicom_segmentation(const VolumeRead& map, const std::filesystem::path& path,
                                                          const std::filesystem::path& series,
                                                          Progress* progress = nullptr,
                                                          const std::string& series_uid = {});

}  // namespace homolog
