#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <thread>
#include <utility>

#include "core/base/progress.h"
#include "core/base/result.h"

namespace homolog {

/// Does one piece of work after the other on a thread of its own. What is asked for last wins: what runs is cancelled
/// then, and its result dropped. Work for which memory is wanting fails with a sentence.
template <class Value>
class LatestWins {
 public:
  using Work = std::function<Result<Value>(Progress&)>;

  /// `wake` is called from the thread when a result is there.
  explicit LatestWins(std::function<void()> wake) : wake_(std::move(wake)), thread_([this] { run(); }) {}
  ~LatestWins() {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
      progress_->cancel();
    }
    changed_.notify_all();
    thread_.join();
  }
  LatestWins(const LatestWins&) = delete;
  LatestWins& operator=(const LatestWins&) = delete;

  void start(Work work) {
    {
      const std::lock_guard lock(mutex_);
      progress_->cancel();
      progress_ = std::make_shared<Progress>();
      next_ = std::move(work);
      result_.reset();
      busy_ = true;
    }
    changed_.notify_all();
  }
  /// Drops what runs and what waits.
  void cancel() {
    const std::lock_guard lock(mutex_);
    progress_->cancel();
    next_ = nullptr;
    result_.reset();
    busy_ = false;
  }
  bool busy() const {
    const std::lock_guard lock(mutex_);
    return busy_;
  }
  double fraction() const {
    const std::lock_guard lock(mutex_);
    return progress_->fraction();
  }
  /// The latest work's result, once.
  std::optional<Result<Value>> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(result_, std::nullopt);
  }
  /// Waits until nothing is left to do.
  void finish() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !busy_; });
  }

 private:
  static Result<Value> done(const Work& work, Progress& progress) {
    try {
      return work(progress);
    } catch (const std::bad_alloc&) {
      return fail("", "This needs more memory than there is; close other programs.");
    }
  }

  void run() {
    std::unique_lock lock(mutex_);
    for (;;) {
      changed_.wait(lock, [this] { return stopping_ || next_; });
      if (stopping_) return;
      const Work work = std::exchange(next_, nullptr);
      const auto progress = progress_;
      lock.unlock();
      Result<Value> result = done(work, *progress);
      lock.lock();
      if (progress->cancelled() || progress != progress_) continue;
      result_ = std::move(result);
      busy_ = false;
      changed_.notify_all();
      lock.unlock();
      wake_();
      lock.lock();
    }
  }

  std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::shared_ptr<Progress> progress_ = std::make_shared<Progress>();
  Work next_;
  std::optional<Result<Value>> result_;
  bool busy_ = false, stopping_ = false;
  std::thread thread_;
};

}  // namespace homolog
