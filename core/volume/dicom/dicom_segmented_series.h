#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/volume/dicom/dicom_header.h"
#include "core/volume/dicom/dicom_set.h"
#include "core/volume/volume_io.h"

namespace homolog {

/// A segmentation on the grid of what it was made on [read_dicom_segmentation]. `image`: beside which it is read. If
/// that has another space or other voxels, the series that it was made on counts, if its files lie in the same folder:
/// the one with most of the images that it refers to, else the one that it names.
Result<VolumeRead> read_segmentation_on_series(const DicomSet& set, const std::optional<ImageGrid>& image,
                                               Progress* progress);

/// The images of a folder, by the UID of their series.
using SeriesByUid = std::map<std::string, std::vector<DicomHeader>>;

/// The series that a segmentation or contours were made on: the one with most of the images that they refer to, else
/// the first that they name; the end where there is none.
SeriesByUid::const_iterator series_of(const ReferencedImages& made_on, const SeriesByUid& series);

}  // namespace homolog
