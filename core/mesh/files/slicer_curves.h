#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/numbers/geometry.h"
#include "core/base/result.h"

namespace homolog {

/// A curve of 3D Slicer.
struct SlicerCurve {
  std::vector<Vec3> points;  ///< the placed points, LPS mm
  bool closed = true;
  std::string
      type{};  ///< how it runs between them: "spline", "linear", …; empty: not said, as in 3D Slicer's own files
};

/// Reads the curves of a `.mrk.json`: markups "Curve" and "ClosedCurve"; RAS is turned to LPS. Errors: as of
/// read_landmarks [landmark_io.h]; a file with points alone.
Result<std::vector<SlicerCurve>> read_slicer_curves(const std::filesystem::path& path);

}  // namespace homolog
