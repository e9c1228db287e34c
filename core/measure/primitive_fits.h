#pragma once

#include "core/base/numbers/geometry.h"
#include "core/base/result.h"

namespace homolog {

// Simple shapes through points, by least squares of the distances. `points`: n×3, mm; `weights`: n, ≥ 0, such as the
// area that each vertex stands for. Turning, shifting and scaling the points does the same to the result.

struct FittedLine {
  Vec3 at = Vec3::Zero();  ///< mm: the mean of the points
  Vec3 direction = Vec3::UnitZ();
  double rms_mm = 0;  ///< root mean square of the points' distances
};
struct FittedPlane {
  Vec3 at = Vec3::Zero();  ///< mm: the mean of the points
  Vec3 normal = Vec3::UnitZ();
  double rms_mm = 0;
};
struct FittedSphere {
  Vec3 centre = Vec3::Zero();
  double radius_mm = 0, rms_mm = 0;
};
struct FittedCylinder {
  Vec3 at = Vec3::Zero();  ///< a place on the axis, amid the points
  Vec3 direction = Vec3::UnitZ();
  double radius_mm = 0, rms_mm = 0;
};

/// The axis along which the points spread most. Errors: fewer than 2 points, no such axis.
Result<FittedLine> fit_line(const Points& points, const VertexScalars& weights);
/// Errors: fewer than 3 points, points on a line.
Result<FittedPlane> fit_plane(const Points& points, const VertexScalars& weights);
/// Gauss and Newton's steps from the algebraic fit. Errors: fewer than 4 points, points in a plane.
Result<FittedSphere> fit_sphere(const Points& points, const VertexScalars& weights);
/// Levenberg and Marquardt's steps from each of the points' three main axes; the best is kept. Errors: fewer than 6
/// points, points on a line, none of the starts leads to a cylinder.
Result<FittedCylinder> fit_cylinder(const Points& points, const VertexScalars& weights);

}  // namespace homolog
