#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/mesh/topology.h"
#include "core/model/shape_model.h"

namespace homolog {

/// A mean over shapes or samples and its standard error.
struct Measured {
  double mean = 0, standard_error = 0;
};
/// One value for each mode count.
using Measures = std::vector<Measured>;

/// Mean and deviation/√n of n numbers, the deviation with 1/(n−1); 0 for one number.
Measured measured(const Eigen::VectorXd& values);

// The definitions, and what to read from the numbers, are in docs/models.md. Coefficients are never clamped here, and
// shapes are not aligned again when one is left out. "At every mode count" is m = 1…M−2, entry m − 1; distances in mm.

/// Cumulative share (0…1) of the variance, at every mode count. Standard error: by the delta method from √(2/M)·λ of
/// each variance [Styner 2003]; 0 where all is held.
Measures compactness(const PrincipalComponents& components);
/// Distance of each shape to its reconstruction by the model of all others: root mean square over the vertices,
/// averaged over the shapes; at every mode count.
Measures generalisation_rms(const PrincipalComponents& components);
/// Distance of random shapes b ~ N(0, λ) to the nearest training shape, root mean square over the vertices; at every
/// mode count.
Measures specificity_rms(const PrincipalComponents& components, Eigen::Index samples, std::uint64_t seed);

/// How far each shape lies from its reconstruction by the model of all others, averaged over the shapes.
struct Generalisation {
  Measures mean;     ///< the mean Euclidean distance of the vertices
  Measures surface;  ///< the symmetric mean surface distance; empty without faces
};
/// At the mode counts `modes` (each 1…M−2). The models of the others are made once for both: of many shapes that takes
/// long. The working memory beside the components is M×M numbers. Errors: cancelled.
Result<Generalisation> generalisation(const PrincipalComponents& components,
                                      const std::shared_ptr<const Topology>& topology, const std::vector<int>& modes,
                                      Progress* progress = nullptr);
/// As specificity_rms with the mean Euclidean distance of the vertices, at the mode counts `modes`.
/// `singular_values_as_variances` draws b ~ N(0, √((M−1) λ)): ShapeWorks takes the singular values of the centred
/// shapes for the variances of its samples.
Result<Measures> specificity_mean(const PrincipalComponents& components, const std::vector<int>& modes,
                                  Eigen::Index samples, std::uint64_t seed, bool singular_values_as_variances = false,
                                  Progress* progress = nullptr);

}  // namespace homolog
