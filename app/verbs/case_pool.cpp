#include "app/verbs/case_pool.h"

#include <mutex>
#include <utility>

#include "core/base/processes/guarded.h"
#include "core/base/processes/parallel.h"

namespace homolog {

namespace {

struct InWork {
  std::mutex mutex;
  std::string name;
};

InWork& in_work() {
  static InWork one;
  return one;
}

}  // namespace

std::string case_in_work() {
  const std::lock_guard lock(in_work().mutex);
  return in_work().name;
}

void set_case_in_work(std::string name) {
  const std::lock_guard lock(in_work().mutex);
  in_work().name = std::move(name);
}

std::vector<Result<Report>> run_cases(std::size_t count,
                                      const std::function<Result<Report>(std::size_t, Progress&)>& work,
                                      Progress& progress) {
  std::vector<Result<Report>> results(count, Result<Report>(Report{}));
  for_each_in_parallel(count, [&](std::size_t i) {
    Progress own(progress, 1 / static_cast<double>(count));
    results[i] = [&]() -> Result<Report> {
      if (own.cancelled()) return fail("", "the run was cancelled");
      return guarded("", [&] { return work(i, own); });
    }();
    own.part(0, 1);
    own.report(1);
  });
  set_case_in_work({});
  return results;
}

}  // namespace homolog
