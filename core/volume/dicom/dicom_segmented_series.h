#pragma once

#include <optional>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/volume/dicom/dicom_set.h"
#include "core/volume/volume_io.h"

namespace homolog {

/// A segmentation on the grid of what it was made on [read_dicom_segmentation]. `image`: beside which it is read. If
/// that has another space or other voxels, the series that it was made on counts, if its files lie in the same folder:
/// the one with most of the images that it refers to, else the one that it names.
Result<VolumeRead> read_segmentation_on_series(const DicomSet& set, const std::optional<ImageGrid>& image,
                                               Progress* progress);

}  // namespace homolog
