#include "app/editor/work/quality_monitor.h"

#include <chrono>
#include <utility>

namespace homolog {

namespace {
/// A drag posts meshes faster than they are measured; this leaves the processor to drawing it.
constexpr int share_of_rest = 9;
}  // namespace

QualityMonitor::QualityMonitor(std::function<void()> wake) : wake_(std::move(wake)), thread_([this] { run(); }) {}

QualityMonitor::~QualityMonitor() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void QualityMonitor::post(std::shared_ptr<const Document> document) {
  {
    const std::lock_guard lock(mutex_);
    if (!document || !document->has_shape()) {
      latest_.reset();
      next_.reset();
      abandoned_ = true;
      return;
    }
    next_ = std::move(document);
  }
  changed_.notify_all();
}

std::optional<QualityFigures> QualityMonitor::latest() const {
  const std::lock_guard lock(mutex_);
  return latest_;
}

void QualityMonitor::finish() {
  std::unique_lock lock(mutex_);
  hurried_ = true;
  changed_.notify_all();
  changed_.wait(lock, [this] { return !next_ && !measuring_; });
  hurried_ = false;
}

void QualityMonitor::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return stopping_ || next_; });
    if (stopping_) return;
    const auto document = std::exchange(next_, nullptr);
    measuring_ = true;
    abandoned_ = false;
    lock.unlock();
    const auto started = std::chrono::steady_clock::now();
    const QualityFigures figures = quality_figures(*document);
    const auto rest = share_of_rest * (std::chrono::steady_clock::now() - started);
    lock.lock();
    measuring_ = false;
    if (!abandoned_) latest_ = figures;
    changed_.notify_all();
    lock.unlock();
    wake_();
    lock.lock();
    changed_.wait_for(lock, rest, [this] { return stopping_ || hurried_; });
  }
}

}  // namespace homolog
