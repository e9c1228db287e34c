#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/numbers/geometry.h"
#include "core/base/result.h"
#include "core/volume/dicom/dicom_header.h"
#include "core/volume/volume.h"

namespace homolog {

/// A plane and where it comes from.
struct DicomPlaneSource {
  std::size_t file = 0, plane_in_file = 0;
  const DicomPlane* plane = nullptr;
  double along_normal_mm = 0;
  DicomTimes times;  ///< the plane's times; past midnight they go on
};

/// The planes in the order of the volume (slices fastest, then frames), and its grid.
struct DicomArrangement {
  std::vector<DicomPlaneSource> planes;
  int slices = 0, frames = 1;
  Mat3 steps_mm = Mat3::Identity();
  Vec3 origin_mm = Vec3::Zero();
  double frame_seconds = 0;
  /// The reason why its slices are no even stack, where that was let through ("unevenly spaced slices: …"); `steps_mm`
  /// is then as if they began with the first, a pixel behind one another.
  std::string uneven{};
};

/// Orders the planes of one series: from slice to slice along their normal, and by time where several lie at every
/// place. `path` is named in errors: planes of different sizes, directions, spaces or echo times, a slice that is
/// missing, uneven or shifted to the side, and several at one place that are no frames. `warnings`: what was assumed.
/// `resample`: slices that are missing, uneven or shifted are no error, but for resample_slices.
Result<DicomArrangement> arrange(const std::filesystem::path& path, const std::vector<DicomHeader>& headers,
                                 std::vector<std::string>& warnings, bool resample = false);

/// The planes whose file has a UID, as the images of the volume that an arrangement is of.
std::vector<SourceImage> images_of(const std::vector<DicomHeader>& headers, const DicomArrangement& arrangement);

}  // namespace homolog
