#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "app/editor/state/quality.h"

namespace homolog {

/// Measures the shown mesh on a thread of its own; the latest mesh posted wins. It rests between meshes that
/// follow each other closely, as during a drag.
class QualityMonitor {
 public:
  /// `wake` is called from the thread after every new result.
  explicit QualityMonitor(std::function<void()> wake);
  ~QualityMonitor();
  QualityMonitor(const QualityMonitor&) = delete;
  QualityMonitor& operator=(const QualityMonitor&) = delete;

  /// A document without a mesh (or null) forgets the figures so far.
  void post(std::shared_ptr<const Document> document);
  /// Of the latest mesh that is measured; nothing before the first.
  std::optional<QualityFigures> latest() const;
  /// Waits until the mesh posted last is measured.
  void finish();

 private:
  void run();
  std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::shared_ptr<const Document> next_;
  std::optional<QualityFigures> latest_;
  bool measuring_ = false, abandoned_ = false, hurried_ = false, stopping_ = false;
  std::thread thread_;
};

}  // namespace homolog
