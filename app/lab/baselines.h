#pragma once

#include "core/adapt/boundary/boundary.h"
#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/template/template.h"

namespace homolog {

// Two ways to fit that a fit is measured against. Both place the template as the fit does, without landmarks.

struct PointDriftOptions {
  Eigen::Index points = 1000;  ///< points of the template; a half more of the target
  double beta = 2;             ///< width of the smoothing, and
  double lambda = 3;           ///< its weight, both in units in which the points' deviation is 1
  double outliers = 0.1;       ///< share of the target that belongs to nothing
  int most_rounds = 60;
  Progress* progress = nullptr;
};

/// Coherent point drift [Myronenko and Song 2010, Fig. 4]: where the points of `moving` (m×3) go when they are carried
/// smoothly to the points of `fixed`. All m rows are carried by the drift of every k-th. Errors: fewer than four
/// points; points without extent; cancelled.
Result<Points> point_drift(const Points& moving, const Points& fixed, const PointDriftOptions& options = {});

/// Every vertex of the placed template at the closest point of the boundary, n×3, mm.
Points closest_points_fit(const Template& the_template, const Boundary& boundary);
/// Point drift of the placed template, then the closest points. Errors: those of point_drift.
Result<Points> point_drift_fit(const Template& the_template, const Boundary& boundary,
                               const PointDriftOptions& options = {});

}  // namespace homolog
