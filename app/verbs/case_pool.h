#pragma once

#include <functional>
#include <vector>

#include "app/verbs/verb.h"

namespace homolog {

/// Runs `work` on cases 0 … count − 1, as many at a time as `thread_limit` allows, and returns what became of each.
/// Cases share nothing; each has a Progress of its own, which `progress` sums up and whose cancellation it passes on.
std::vector<Result<Report>> run_cases(std::size_t count,
                                      const std::function<Result<Report>(std::size_t, Progress&)>& work,
                                      Progress& progress);

}  // namespace homolog
