#include "app/verbs/progress_line.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>

#include "app/verbs/case_pool.h"
#include "core/base/processes/process.h"
#include "core/base/text/text.h"

namespace homolog {

std::string time_left(double fraction, double seconds) {
  constexpr double enough = 0.02, soon_seconds = 2;
  if (fraction < enough || seconds < soon_seconds || fraction >= 1) return {};
  const double left = seconds * (1 - fraction) / fraction;
  char text[64];
  if (left < 90)
    std::snprintf(text, sizeof text, "about %.0f s left", std::max(1.0, std::ceil(left)));
  else if (left < 5400)
    std::snprintf(text, sizeof text, "about %.0f min left", std::ceil(left / 60));
  else
    std::snprintf(text, sizeof text, "about %.1f h left", left / 3600);
  return text;
}

ProgressLine::ProgressLine(const Progress& progress, bool quiet) {
  if (quiet || !errors_are_seen()) return;
  thread_ = std::jthread([this, &progress](const std::stop_token& stop) {
    const auto start = std::chrono::steady_clock::now();
    std::unique_lock lock(mutex_);
    bool shown = false;
    double farthest = 0;  // a work that has to begin anew stands still for a while
    for (int tick = 0; !stop.stop_requested(); ++tick) {
      stopped_.wait_for(lock, stop, std::chrono::milliseconds(100), [] { return false; });
      if (tick < 5 || stop.stop_requested()) continue;
      farthest = std::max(farthest, std::min(progress.fraction(), 1.0));
      const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      std::string what = printable(case_in_work());
      const std::string left = time_left(farthest, seconds);
      if (!left.empty()) what += (what.empty() ? "" : ", ") + left;
      std::fprintf(stderr, "\r\033[K%3.0f %%%s%s (Ctrl-C stops)", 100 * farthest, what.empty() ? "" : " ",
                   what.c_str());
      shown = true;
    }
    if (shown) std::fputs("\r\033[K", stderr);
  });
}

}  // namespace homolog
