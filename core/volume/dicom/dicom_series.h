#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/volume/dicom/dicom_arrangement.h"
#include "core/volume/volume.h"
#include "core/volume/volume_io.h"

namespace homolog {

/// A series of images without its pixels: what a segmentation of it refers to.
struct DicomSeries {
  std::vector<DicomHeader> headers;
  DicomArrangement arrangement;  ///< its planes lie in `headers`
  VolumeGeometry grid;
  DicomItem about;  ///< the elements of the first file: patient, study
};

/// Reads the only series of images of a folder, or the one of that UID, or one file of several planes. `resample`:
/// slices that are no even stack are no error [DicomArrangement::uneven]; then `grid` is not theirs. Errors: those of
/// read_volume.
Result<DicomSeries> read_dicom_series(const std::filesystem::path& path, Progress* progress = nullptr,
                                      bool resample = false, const std::string& series_uid = {});

/// The segmentations (SEG) of a folder that holds several of them and no images, by name; none of any other folder.
std::vector<std::filesystem::path> segmentations_in(const std::filesystem::path& folder);

/// The images that the segmentation or structure set of a file was made on; none of any other file.
ReferencedImages images_made_on(const std::filesystem::path& path);

/// The folder in `folder` that holds one of these series, where the latter holds no DICOM files itself (a study); else
/// `folder`.
std::filesystem::path folder_of_series(const std::filesystem::path& folder, const std::vector<std::string>& series);

}  // namespace homolog
