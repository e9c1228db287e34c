#include "app/editor/work/exports.h"

#include <new>
#include <utility>

namespace homolog {

Exports::Exports(std::function<void()> wake) : wake_(std::move(wake)), thread_([this] { run(); }) {}

Exports::~Exports() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Exports::start(std::filesystem::path path, Write write) {
  {
    const std::lock_guard lock(mutex_);
    jobs_.push_back({std::move(path), std::move(write)});
  }
  changed_.notify_all();
}

void Exports::cancel(const std::filesystem::path& path) {
  const std::lock_guard lock(mutex_);
  if (!jobs_.empty() && jobs_.front().path == path) jobs_.front().progress->cancel();
}

std::optional<Exports::Running> Exports::running() const {
  const std::lock_guard lock(mutex_);
  if (jobs_.empty()) return std::nullopt;
  const Job& job = jobs_.front();
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - job.asked;
  return Running{job.path, job.progress->fraction(), passed.count()};
}

std::vector<Exports::Written> Exports::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(written_, {});
}

void Exports::finish() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return jobs_.empty(); });
}

void Exports::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return stopping_ || !jobs_.empty(); });
    if (jobs_.empty()) return;
    const Job& job = jobs_.front();  // a deque's elements stay where they are while others are added at its end
    lock.unlock();
    Result<void> result;
    try {
      result = job.write(*job.progress);
    } catch (const std::bad_alloc&) {
      result = fail(job.path.string(), "needs more memory than there is; close other programs");
    }
    lock.lock();
    written_.push_back({job.path, std::move(result), job.progress->cancelled()});
    jobs_.pop_front();
    changed_.notify_all();
    lock.unlock();
    wake_();
    lock.lock();
  }
}

}  // namespace homolog
