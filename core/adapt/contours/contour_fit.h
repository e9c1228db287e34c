#pragma once

#include "core/adapt/annealing.h"
#include "core/adapt/contours/contour_samples.h"
#include "core/adapt/fit.h"

namespace homolog {

/// How far contours lie from a mesh, mm; of one that lies outside of the organ, how far the mesh reaches beyond it.
/// The rims of holes are left out of a mesh without tunnels.
struct ContourDistance {
  double mean_mm = 0, p95_mm = 0;
};
ContourDistance contour_distance(const std::vector<DrawnContour>& contours, const Mesh& mesh);

/// Fits a template to curves in some planes: placed by where they lie, carried to them smoothly [contour_warp.h], then
/// drawn onto them [Erdt 2009, Eq. 3]. Between the curves the shape follows the template. `doubt_mm` grows with the
/// distance from them. The options `partial` and `allowed` are left out. Errors: no curve with points;
/// curves of no extent; a placement beside them; cancelled.
Result<FitResult> fit_to_contours(const Template& the_template, const std::vector<DrawnContour>& contours,
                                  const FitOptions& options = {});

/// The same with the boundary of a label too: fitted to this first [fit_to_boundary], then drawn to the contours where
/// there are some and to the boundary elsewhere. If both say something, the contours count. Errors: those of both.
Result<FitResult> fit_to_contours_and_boundary(const Template& the_template, const std::vector<DrawnContour>& contours,
                                               const Boundary& boundary, const FitOptions& options = {});

/// Places of a mesh that is fitted to contours, and where these have them: for a snap that keeps to them. Those that
/// lie outside of the organ give none.
std::vector<Pin> contour_pins(const std::vector<DrawnContour>& contours, const Mesh& mesh);

}  // namespace homolog
