#include "app/verbs/case_pool.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <new>
#include <thread>

namespace homolog {

std::vector<Result<Report>> run_cases(std::size_t count,
                                      const std::function<Result<Report>(std::size_t, Progress&)>& work,
                                      Progress& progress) {
  std::vector<Result<Report>> results(count, Result<Report>(Report{}));
  std::vector<Progress> each(count);
  std::atomic<std::size_t> next{0}, done{0};
  const auto run = [&](std::size_t i) -> Result<Report> {
    if (each[i].cancelled()) return fail("", "the run was cancelled");
    try {
      return work(i, each[i]);
    } catch (const std::bad_alloc&) {
      return fail("", "memory ran out; close other programs, or use a machine with more memory");
    } catch (const std::filesystem::filesystem_error& error) {
      return fail(error.path1().string(), error.code().message());
    }
  };
  const auto take_cases = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      results[i] = run(i);
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
