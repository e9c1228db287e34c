#include "core/base/processes/parallel.h"

#include <atomic>
#include <condition_variable>
#include <exception>
#include <limits>
#include <list>
#include <mutex>
#include <thread>
#include <vector>

namespace homolog {

namespace {

/// One loop. Whoever takes part takes the next piece until none is left, or a piece throws. Pieces are taken in order,
/// so that all before the first that throws are done, and its exception is the one that is kept.
class SharedLoop {
 public:
  SharedLoop(std::size_t count, const std::function<void(std::size_t)>& work) : count_(count), work_(work) {}

  bool has_more() const { return next_ < count_; }
  void take_part() {
    for (std::size_t k = next_++; k < count_; k = next_++) {
      try {
        work_(k);
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (k < thrown_at_) {
          thrown_at_ = k;
          thrown_ = std::current_exception();
        }
        next_ = count_;
      }
    }
  }
  /// Once nobody takes part any more.
  void pass_on_exception() const {
    if (thrown_) std::rethrow_exception(thrown_);
  }

  int helpers = 0;  ///< guarded by the pool

 private:
  std::size_t count_;
  const std::function<void(std::size_t)>& work_;
  std::atomic<std::size_t> next_ = 0;
  std::mutex mutex_;
  std::size_t thrown_at_ = std::numeric_limits<std::size_t>::max();
  std::exception_ptr thrown_;
};

/// The helpers of all loops.
class Helpers {
 public:
  static Helpers& the() {
    static Helpers pool;
    return pool;
  }

  int limit() {
    const std::lock_guard lock(mutex_);
    return limit_;
  }
  void set_limit(int threads) {
    const std::lock_guard lock(mutex_);
    limit_ = std::max(1, threads);
  }

  void run(SharedLoop& loop) {
    std::list<SharedLoop*>::iterator place;
    {
      const std::lock_guard lock(mutex_);
      start_helpers();
      place = loops_.insert(loops_.end(), &loop);
    }
    wake_.notify_all();
    loop.take_part();
    std::unique_lock lock(mutex_);
    loops_.erase(place);
    left_.wait(lock, [&] { return loop.helpers == 0; });
  }

 private:
  Helpers() : limit_(std::max(1, static_cast<int>(std::thread::hardware_concurrency()))) {}

  /// Threads are started when they are first wanted. Where the system gives no more, those that there are do the work.
  void start_helpers() {
    try {
      while (static_cast<int>(helpers_.size()) < limit_ - 1)
        helpers_.emplace_back([this](const std::stop_token& stop) { help(stop); });
    } catch (const std::system_error&) {
      limit_ = static_cast<int>(helpers_.size()) + 1;
    }
  }

  /// The youngest loop first: it is within an older one, which waits for it.
  SharedLoop* loop_to_help() const {
    if (busy_ >= limit_ - 1) return nullptr;
    for (auto loop = loops_.rbegin(); loop != loops_.rend(); ++loop)
      if ((*loop)->has_more()) return *loop;
    return nullptr;
  }

  void help(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    for (;;) {
      SharedLoop* loop = nullptr;
      wake_.wait(lock, stop, [&] { return (loop = loop_to_help()) != nullptr; });
      if (loop == nullptr) return;
      ++loop->helpers;
      ++busy_;
      lock.unlock();
      loop->take_part();
      lock.lock();
      --busy_;
      if (--loop->helpers == 0) left_.notify_all();
    }
  }

  std::mutex mutex_;
  std::condition_variable_any wake_, left_;
  std::list<SharedLoop*> loops_;
  int limit_, busy_ = 0;
  std::vector<std::jthread> helpers_;  ///< last, so that they end before what they use does
};

}  // namespace

int thread_limit() {
  return Helpers::the().limit();
}
void set_thread_limit(int threads) {
  Helpers::the().set_limit(threads);
}

void for_each_in_parallel(std::size_t count, const std::function<void(std::size_t)>& work) {
  SharedLoop loop(count, work);
  if (count <= 1 || thread_limit() == 1) {
    loop.take_part();
  } else {
    Helpers::the().run(loop);
  }
  loop.pass_on_exception();
}

}  // namespace homolog
