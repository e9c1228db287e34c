#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/verbs/verb.h"

namespace homolog {

/// Runs `work` on cases 0 … count − 1, as many at a time as `thread_limit` allows, and returns what became of each.
/// Cases share nothing; each has a Progress of its own, which `progress` sums up and whose cancellation it passes on.
std::vector<Result<Report>> run_cases(std::size_t count,
                                      const std::function<Result<Report>(std::size_t, Progress&)>& work,
                                      Progress& progress);

/// The case that the progress line names as being in work; empty: nothing. Any thread may call both.
std::string case_in_work();
void set_case_in_work(std::string name);

}  // namespace homolog
