#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "core/base/processes/guarded.h"
#include "core/base/processes/progress.h"
#include "core/base/result.h"

namespace homolog {

/// The job that a worker is at, for a progress bar.
struct RunningJob {
  std::string subject;
  double fraction = 0;
  double seconds = 0;     ///< since it was asked for
  const char* verb = "";  ///< the verb of the work: "Writing"; empty where nobody said
};

/// Does work beside the window, on a thread of its own: one job after the other, in the order in which they were asked
/// for. Whatever a job throws becomes the sentence of its result. The members are called from one thread, the window's.
template <class Value>
class Worker {
 public:
  /// Gets all that it needs with it; shares nothing that changes.
  using Work = std::function<Result<Value>(Progress&)>;

  /// `wake` is called from the thread when a result is there.
  explicit Worker(std::function<void()> wake) : wake_(std::move(wake)) {}
  /// Gives up what runs and what waits.
  ~Worker() {
    cancel();
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// Asks for work after all that was asked for before. `subject` says what it is about: a file's name, or nothing.
  /// `verb` says what it does to that.
  void queue(std::string subject, Work work, const char* verb = "") {
    if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
    {
      const std::lock_guard lock(mutex_);
      jobs_.push_back(std::make_shared<Job>(std::move(subject), std::move(work), verb));
    }
    changed_.notify_all();
  }
  /// Asks for work in place of all that was asked for before, whose results are dropped.
  void start(std::string subject, Work work) {
    cancel();
    queue(std::move(subject), std::move(work));
  }
  /// Gives up what runs and what waits, and drops the results that were not taken.
  void cancel() {
    const std::lock_guard lock(mutex_);
    for (const auto& job : jobs_) job->progress.cancel();
    jobs_.clear();
    results_.clear();
  }
  /// Asks the running job to end early if it is about `subject`. Its result comes all the same, and waiting jobs are
  /// done.
  void cancel_running(const std::string& subject) {
    const std::lock_guard lock(mutex_);
    if (!jobs_.empty() && jobs_.front()->subject == subject) jobs_.front()->progress.cancel();
  }

  bool busy() const {
    const std::lock_guard lock(mutex_);
    return !jobs_.empty();
  }
  std::optional<RunningJob> running() const {
    const std::lock_guard lock(mutex_);
    if (jobs_.empty()) return std::nullopt;
    const Job& job = *jobs_.front();
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - job.asked;
    return RunningJob{job.subject, job.progress.fraction(), passed.count(), job.verb};
  }
  /// Says how much is done of what runs; 0 where nothing runs.
  double fraction() const {
    const std::lock_guard lock(mutex_);
    return jobs_.empty() ? 0 : jobs_.front()->progress.fraction();
  }
  /// The oldest result that was not taken yet.
  std::optional<Result<Value>> take() {
    const std::lock_guard lock(mutex_);
    if (results_.empty()) return std::nullopt;
    std::optional<Result<Value>> oldest(std::move(results_.front()));
    results_.pop_front();
    return oldest;
  }
  /// Waits until nothing is left to do.
  void finish() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return jobs_.empty(); });
  }

 private:
  struct Job {
    Job(std::string about, Work asked_work, const char* does)
        : subject(std::move(about)), work(std::move(asked_work)), verb(does) {}
    std::string subject;
    Work work;
    const char* verb;
    Progress progress;
    std::chrono::steady_clock::time_point asked = std::chrono::steady_clock::now();
  };

  void run() {
    while (const std::shared_ptr<Job> job = next()) {
      Result<Value> result = guarded(job->subject, [&] { return job->work(job->progress); });
      job->work = nullptr;  // the data that it held are freed on this thread, before the result is seen
      if (deliver(job, result) && wake_) wake_();
    }
  }
  /// Waits for a job; null where there will be none.
  std::shared_ptr<Job> next() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return stopping_ || !jobs_.empty(); });
    return jobs_.empty() ? nullptr : jobs_.front();
  }
  /// False where the job was given up meanwhile; its result stays the caller's then.
  bool deliver(const std::shared_ptr<Job>& job, Result<Value>& result) {
    {
      const std::lock_guard lock(mutex_);
      if (jobs_.empty() || jobs_.front() != job) return false;
      jobs_.pop_front();
      results_.push_back(std::move(result));
    }
    changed_.notify_all();
    return true;
  }

  std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::shared_ptr<Job>> jobs_;  ///< the first is being done
  std::deque<Result<Value>> results_;
  bool stopping_ = false;
  std::thread thread_;  ///< runs from the first job on
};

}  // namespace homolog
