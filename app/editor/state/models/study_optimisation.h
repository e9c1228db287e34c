#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/editor/state/models/study_model.h"
#include "core/groupwise/optimise.h"

namespace homolog {

/// The input of an optimisation: the shapes of a study, and how its model aligns them.
struct StudyToOptimise {
  ShapesOfStudy fitted;  ///< the study's shapes, with a model
  Alignment alignment = Alignment::similarity;
};

/// The result of an optimisation.
struct OptimisedStudy {
  ShapesOfStudy shapes;  ///< shapes of the cases in the model
  SetFigures before, after;
  double largest_slide_mm = 0, surface_moved_mm = 0;
};

/// The optimisation of the study in hand: one that runs, or one whose result can be shown. The study's files and cases
/// stay as they are.
struct StudyOptimisation {
  std::shared_ptr<const StudyToOptimise> of;   ///< null where there is none
  std::vector<double> bits;                    ///< description length after 0, 1, 2 … rounds
  double fraction = 0;                         ///< share of the work that is done
  std::shared_ptr<const OptimisedStudy> done;  ///< null while it runs
  bool shown = false;                          ///< the optimised shapes, not those that were fitted

  bool runs() const { return of && !done; }
};

/// Why the study has other shapes by now than those that are or were optimised, as the end of a sentence: "anna has
/// changed". Empty where they are the same.
std::string why_outdated(const StudyToOptimise& of, const ShapesOfStudy& now, Alignment alignment);

}  // namespace homolog
