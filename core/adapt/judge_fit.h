#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/adapt/fit.h"
#include "core/measure/compare.h"
#include "core/mesh/parts/rims.h"
#include "core/template/template.h"

namespace homolog {

/// A place whose doubt exceeds this share of the root of the boundary's area has to be looked at.
inline constexpr double most_doubt_share = 0.06;  ///< real organs of the template's kind come to 0.02 to 0.04
inline double much_doubt_mm(double area_mm2) {
  return most_doubt_share * std::sqrt(area_mm2);
}

/// The mean doubt of a fit as a share of the root of the mesh's area.
double share_of_doubt(const FitResult& fit);

/// How far the target of a partial fit lies from the mesh, the cuts through the organ left out.
struct TargetDistance {
  double mean_mm = 0, p95_mm = 0;
};

/// How good a fit is, and what a person should look at.
struct FitJudgement {
  Agreement agreement;  ///< the fitted mesh against the boundary, all of both
  /// The same of what the scan shows: both are cut along its borders, and the cuts do not count. As `agreement` where
  /// the scan cuts nothing off.
  Agreement inside_scan;
  double beyond_share = 0;  ///< share of the mesh's area beyond the scan's borders, where it follows the template
  /// By what the scan shows: Dice below 0.9 (of rims that belong to each other: apart by more than 1 % of the diagonal
  /// on average), a mean distance above 1 % of the boundary's diagonal, a 95 % distance above 4 %, a mean doubt above 6
  /// % of the root of its area, more than 60 % of the mesh beyond the scan, an open surface for a closed template, or
  /// mirrored. A partial fit: `sound_mm` or the target's mean distance above 1 %, the mean doubt of what is there above
  /// 6 % of the root of the mesh's area, more than 60 % missing, or mirrored.
  bool doubtful = false;
  /// Both the mesh and the boundary have a rim: Dice, which would need a cap, is left out then.
  std::optional<RimDistance> rim;
  double beyond_rim_share = 0;  ///< share of a closed boundary's area beyond an open mesh's rim and off its flat cap
  double sound_mm = 0;          ///< a partial fit's mean distance of the vertices that are no outliers
  TargetDistance target;        ///< how far a partial fit's target lies from the mesh
  double doubt_share = 0;       ///< the fit's mean doubt within the scan, by the root of the boundary's area
  std::vector<std::string> warnings;  ///< the boundary's, the fit's and those of this; each a sentence
};

/// Judges what fit_to_boundary gave for this template, boundary and these options.
FitJudgement judge_fit(const Template& the_template, const Boundary& boundary, const FitOptions& options,
                       const FitResult& fit);

/// "the fit is poor" as it stands alone: "The fit is poor."
std::string as_sentence(std::string warning);
/// Why a fit is in doubt, as a sentence, of what is said of it; "The fit is doubtful." where nothing is.
std::string reason_of_doubt(const std::vector<std::string>& warnings);

}  // namespace homolog
