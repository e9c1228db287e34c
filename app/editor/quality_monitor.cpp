#include "app/editor/quality_monitor.h"

#include <utility>

namespace homolog {

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
  changed_.wait(lock, [this] { return !next_ && !measuring_; });
}

void QualityMonitor::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return stopping_ || next_; });
    if (stopping_) return;
    const auto document = std::exchange(next_, nullptr);
    measuring_ = true;
    lock.unlock();
    const QualityFigures figures = quality_figures(*document);
    lock.lock();
    measuring_ = false;
    latest_ = figures;
    changed_.notify_all();
    lock.unlock();
    wake_();
    lock.lock();
  }
}

}  // namespace homolog
