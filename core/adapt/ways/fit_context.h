#pragma once

#include <cstddef>

#include "core/adapt/boundary/surface_target.h"
#include "core/adapt/ways/fit_steps.h"
#include "core/adapt/ways/placed_template.h"

namespace homolog {

/// How much of the work of a fit is done, in parts of about the same length.
struct PartsOfWork {
  std::size_t done = 0, all = 1;
};

/// What the ways of one template onto one boundary have in common. A view: all that it names belongs to the Fitting,
/// which outlives the ways. What needs the boundary's surface, rims, cuts or borders asks the target for them.
struct FitContext {
  const Template& the_template;
  SurfaceTarget& target;
  FitSteps& steps;               ///< they draw to this target
  const PlacedTemplate& placed;  ///< where the template begins, with what landmarks say
  double roundness;              ///< of the template, 0 … 1 [fit_doubt.h]
  PartsOfWork& parts;            ///< counted on as a way is gone
};

}  // namespace homolog
