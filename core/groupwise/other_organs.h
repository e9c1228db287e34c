#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/model/alignment/procrustes.h"

namespace homolog {

/// Signs that tell a fit of another organ from the fits of the template's kind, of several with one template.
struct FitSigns {
  double doubt_share = 0;  ///< share_of_doubt of the fit
  double shape_share = 0;  ///< how far its shape lies from the mean shape of all, of the mean's size [shape_shares]
};

/// The fits that there are as the columns of one matrix (3n×M), in their order. `vertices`: of each (n).
ShapeMatrix as_columns(const std::vector<std::optional<Points>>& fits, Eigen::Index vertices);

/// Returns the distance of each fit's shape from the mean shape, as a share of that one's centroid size, after
/// generalised Procrustes analysis. `fits`: 3n×M.
std::vector<double> shape_shares(ShapeMatrix fits);

/// Which fits are likely of another organ: in four times the doubt of most. The doubt of one whose shape lies farther
/// from the mean shape than most counts for so many times more. A sound organ whose clefts are open comes to three
/// times the doubt, and one of unusual shape to twice the doubt and half as far again; their product to 3.6 at most.
/// Nobody can tell of fewer than three.
std::vector<std::size_t> unlike_the_others(const std::vector<FitSigns>& fits);

/// Which volumes are so far from the median that no spread of the others explains it: more than three times larger or
/// smaller, and five times the usual deviation of their logarithms. Nobody can tell of fewer than five. `volumes`: of
/// any unit; those that are not above 0 are left out.
std::vector<std::size_t> unlike_in_volume(const std::vector<double>& volumes);

}  // namespace homolog
