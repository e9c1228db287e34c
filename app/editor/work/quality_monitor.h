#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "app/editor/state/quality.h"
#include "app/editor/work/worker.h"

namespace homolog {

/// Measures the shown mesh beside the window; the latest mesh posted wins. It rests between meshes that follow each
/// other closely, as during a drag. Called from the window's thread only.
class QualityMonitor {
 public:
  using Measure = std::function<QualityFigures(const ShapeView&)>;
  /// `wake` is called from the thread after every new result.
  explicit QualityMonitor(std::function<void()> wake, Measure measure = quality_figures)
      : figures_of_(std::move(measure)), worker_(std::move(wake)) {}

  /// A document without a mesh (or null) forgets the figures so far.
  /// `of`: the structure; empty: the first.
  void post(std::shared_ptr<const Document> document, std::string of = {});
  /// Takes in what was measured, and measures the mesh posted last when it has rested. True where the figures changed.
  bool update();
  /// Whether the mesh posted last is not measured yet.
  bool busy() const { return next_ != nullptr || worker_.busy(); }
  /// Seconds until it has rested; nothing where no mesh waits for that.
  std::optional<double> rest_seconds() const;
  /// Of the latest mesh that is measured; nothing before the first.
  const std::optional<QualityFigures>& latest() const { return latest_; }
  /// Why the mesh posted last could not be measured; empty where it was.
  const std::string& error() const { return error_; }
  /// Waits until the mesh posted last is measured.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  struct Measured {
    QualityFigures figures;
    Clock::duration took{};
  };
  void measure();
  bool take();

  Measure figures_of_;
  Worker<Measured> worker_;
  std::shared_ptr<const Document> next_;
  std::string of_;  ///< of `next_`
  Clock::time_point rested_{};
  std::optional<QualityFigures> latest_;
  std::string error_;
};

}  // namespace homolog
