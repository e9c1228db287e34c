#pragma once

#include <filesystem>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/volume/volume_io.h"

namespace homolog {

/// Whether a file of this name keeps layers: `.seg.nrrd`, and a DICOM segmentation (.dcm).
bool keeps_layers(const std::filesystem::path& path);

/// Writes a label map with its names, colours and layers: `.seg.nrrd` as 3D Slicer writes it, `.mgz` and `.mgh` as
/// FreeSurfer does, all else as write_volume does with a JSON file beside it ("a.json" beside "a.nii.gz"), which
/// take_names_beside reads again. Where either cannot be written both stay as they were. Errors: those of write_volume;
/// layers, which only `.seg.nrrd` holds; a JSON file of that name that is about something else, or that cannot be
/// replaced.
Result<void> write_segmentation(const VolumeRead& map, const std::filesystem::path& path, Progress* progress = nullptr,
                                const std::string& record = {});

/// Writes a folder of single masks, a file of uint8 for each structure, as the reader of such a folder takes it.
/// `like`: the folder that the map was read from; each mask has the name that it has there, else its structure's with
/// .nii.gz. A soft mask whose label is as it was read stays as it is. Errors: the folder; those of write_volume.
Result<void> write_single_masks(const VolumeRead& map, const std::filesystem::path& folder,
                                const std::filesystem::path& like, Progress* progress = nullptr);

}  // namespace homolog
