#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "core/base/processes/progress.h"

namespace homolog {

/// Shows progress on stderr while it is a terminal and the work takes longer than half a second: the share done, the
/// case in work [case_in_work] and about how long it goes on.
class ProgressLine {
 public:
  /// `progress` outlives this. `quiet`: nothing is shown.
  ProgressLine(const Progress& progress, bool quiet);

 private:
  std::mutex mutex_;
  std::condition_variable_any stopped_;
  std::jthread thread_;
};

/// "about 2 min left"; empty where nobody can tell yet.
std::string time_left(double fraction, double seconds);

}  // namespace homolog
