#pragma once

#include <functional>
#include <optional>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/volume/dicom/dicom_set.h"
#include "core/volume/volume_io.h"

namespace homolog {

/// Whether a file is a segmentation in frames (SEG): one of the storage classes of [DICOM PS3.4, B.5], or its modality.
bool is_dicom_segmentation(const DicomSet& set);

/// The images that it was made on.
ReferencedImages segmented_images(const DicomSet& set);

/// Reads a segmentation [DICOM PS3.3, A.51 and A.52, C.8.20]: binary, fractional or a label map. A label is the number
/// of its segment. Segments that overlap lie in layers. Fractional ones are soft masks from 0 to 1, each in a layer of
/// its own as label 1. Frames that were left out are empty slices: on `series`, where the frames lie on that grid or on
/// the images that they refer to, else on the slices that the file declares [dicom_lattice.h], from the first frame to
/// the last; unless the file keeps empty ones, more may lie beyond (Volume::empty_beyond_slices). Frames on the slices
/// that a series had before it was resampled are taken to its grid [take_slices], with a warning. Errors: no frame of
/// reference, a segment that is not described, frames without a place, two of a segment at one place, pixels that are
/// missing or cannot be decoded, a part of a segmentation that lies in several files.
Result<VolumeRead> read_dicom_segmentation(const DicomSet& set, const std::optional<ImageGrid>& series,
                                           Progress* progress);

}  // namespace homolog
