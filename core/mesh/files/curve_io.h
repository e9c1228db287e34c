#pragma once

#include <filesystem>

#include "core/volume/contours.h"

namespace homolog {

/// Reads curves that somebody drew, LPS mm: a DICOM structure set (RTSTRUCT; or a folder with one) [read_contours],
/// curves of 3D Slicer (`.mrk.json`, markups "Curve" and "ClosedCurve"), or the lines of a VTP file. The latter two
/// give one structure, named like the file, without a frame of reference. A curve of 3D Slicer runs smoothly through
/// its points, as its default is shown there: a cubic spline with steps of 1 between points, periodic where it is
/// closed, with slopes of 0 at open ends [vtkCardinalSpline]. One whose "curveType" is "linear" runs straight. A line
/// of VTP is closed where it ends at its first point. `warnings`: curves without points beside others, which are left
/// out; curves of other types. Errors: the readers'; a file without curves; a curve of fewer than two points, or a
/// closed one of fewer than three.
Result<Contours> read_curves(const std::filesystem::path& path);

}  // namespace homolog
