#include "app/verbs/case_pool.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

namespace homolog {

std::vector<Result<Report>> run_cases(std::size_t count,
                                      const std::function<Result<Report>(std::size_t, Progress&)>& work,
                                      Progress& progress) {
  std::vector<Result<Report>> results(count, Result<Report>(Report{}));
  std::vector<Progress> each(count);
  std::atomic<std::size_t> next{0}, done{0};
  const auto take_cases = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      results[i] = each[i].cancelled() ? fail("", "the run was cancelled") : work(i, each[i]);
      each[i].report(1);
      ++done;
    }
  };
  std::vector<std::jthread> workers;
  const std::size_t cores = std::max(1u, std::thread::hardware_concurrency());
  for (std::size_t k = 0; k < std::min(cores, count); ++k) workers.emplace_back(take_cases);
  while (done < count) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    double sum = 0;
    for (Progress& one : each) {
      sum += one.fraction();
      if (progress.cancelled()) one.cancel();
    }
    progress.report(sum / static_cast<double>(count));
  }
  return results;
}

}  // namespace homolog
