#pragma once

#include <functional>
#include <memory>

#include "core/adapt/annealing.h"
#include "core/placement/similarity_fit.h"
#include "core/template/template.h"

namespace homolog {

/// A shape that is allowed, in the frame of the allowed shapes. Both n×3.
struct AllowedShape {
  Points shape;
  Points posed;  ///< the same, shifted, turned and sized to lie best on what it was looked for
};

/// The shapes that an organ may have, as far as they are known: a shape model [core/model/model_prior.h].
struct AllowedShapes {
  Points mean;  ///< n×3, in a frame of its own
  /// The allowed shape nearest to targets (n×3, in that frame): each counts by its weight 0…1, `noise` (of the frame)
  /// along the normal and more freely across it. A large noise keeps to the mean.
  std::function<AllowedShape(const Points& targets, const Points& normals, const VertexScalars& weights, double noise)>
      nearest;
  double beyond = 1;  ///< 0…1: how far the result leaves the allowed shape for what the boundary asks
};

struct AllowedFit {
  Points points;         ///< n×3, LPS mm
  Points shape;          ///< the same in the frame of the allowed shapes
  Similarity placement;  ///< takes `shape` to `points`
};

/// The template with the mean for its shape: what a fit to allowed shapes begins with.
std::shared_ptr<const Template> mean_template(const Template& the_template, const AllowedShapes& allowed);

/// Brings the allowed shape that is nearest to what `force` looks for there, beginning with the mean under `placement`:
/// forces, shape and pose in turn, while the noise falls from 5 % of the extent to 0.4 mean edges. Errors:
/// `after_step`'s.
Result<AllowedFit> fit_allowed(const AllowedShapes& allowed, const std::shared_ptr<const Topology>& topology,
                               Similarity placement, const ForceSource& force, const AfterStep& after_step = {});

}  // namespace homolog
