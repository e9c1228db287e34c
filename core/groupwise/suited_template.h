#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "core/adapt/boundary/boundary.h"
#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/template/template.h"

namespace homolog {

/// The subjects nearest to the mean shape, nearest first and at most `most`: of those that the fits of one start's
/// template find alike, any of which may serve as template. The start is the subject of median size. Subjects that
/// could not be fitted come last. Errors: no template can be made of the start; cancelled.
Result<std::vector<std::size_t>> nearest_to_mean(const std::vector<Boundary>& subjects, std::size_t most, int vertices,
                                                 Progress* progress = nullptr);

/// How well a template made from one subject fits the others.
struct Suitability {
  std::size_t fits = 0;      ///< fits to other subjects
  std::size_t doubtful = 0;  ///< those of them that are doubtful, or not possible at all
  double assd_mm = 0;        ///< mean over these fits of FitJudgement::inside_scan
  double doubt_share = 0;    ///< mean over these fits of FitJudgement::doubt_share

  /// Whether this template suits better: a smaller share of its fits is doubtful, or it lies nearer to the organs.
  bool better_than(const Suitability& other) const;
};

/// Says how well a template suits that was made from subject `own`: it is fitted to up to `most_others` others, from
/// the smallest to the largest. Errors: cancelled.
Result<Suitability> suitability(const Template& the_template, std::size_t own, const std::vector<Boundary>& subjects,
                                std::size_t most_others, Progress* progress = nullptr);

}  // namespace homolog
