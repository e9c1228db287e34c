#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/base/result.h"
#include "core/base/text/lengths.h"
#include "core/volume/dicom/dicom_arrangement.h"

namespace homolog {

/// "2.50 mm".
inline std::string mm_text(double mm) {
  return in_mm(mm, 2);
}

/// The step from slice to slice along the normal of `axes` (unit directions of columns and rows) of an arrangement with
/// several slices; positions may be rounded to a tenth of a millimetre. Errors: a slice that is missing or uneven.
Result<Vec3> slice_step(const std::filesystem::path& path, const std::vector<DicomHeader>& headers,
                        const DicomArrangement& arrangement, const std::pair<Vec3, Vec3>& axes);

/// Errors: a plane, of any frame, lies to the side of the others by more than half a pixel.
Result<void> check_straight(const std::filesystem::path& path, const std::vector<DicomHeader>& headers,
                            const std::vector<DicomPlaneSource>& planes, const std::pair<Vec3, Vec3>& axes,
                            double pixel_mm);

}  // namespace homolog
