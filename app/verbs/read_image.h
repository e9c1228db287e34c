#pragma once

#include <filesystem>

#include "app/verbs/verb.h"
#include "core/volume/volume_io.h"

namespace homolog {

// Volumes as verbs take them: a file, and which frame and label of it. Errors name the file and the option.

/// The image, of which `frame` must exist.
Result<VolumeRead> read_image(const std::filesystem::path& path, int frame, Progress& progress);

struct MaskRead : VolumeRead {
  int label = 0;
};
/// A label map and which label of the frame is meant: `label`, or the only one where that is 0.
Result<MaskRead> read_mask(const std::filesystem::path& path, int label, int frame, Progress& progress);

}  // namespace homolog
