#include "app/editor/work/quality_monitor.h"

#include <algorithm>
#include <utility>

namespace homolog {

namespace {
/// A drag posts meshes faster than they are measured; this leaves the processor to drawing it.
constexpr int share_of_rest = 9;
}  // namespace

void QualityMonitor::post(std::shared_ptr<const Document> document, std::string of) {
  of_ = std::move(of);
  if (document && document->view(of_)) {
    next_ = std::move(document);
    return;
  }
  worker_.cancel();
  next_.reset();
  latest_.reset();
  error_.clear();
}

void QualityMonitor::measure() {
  worker_.queue(
      "The mesh's figures",
      [document = std::exchange(next_, nullptr), of = of_, measure = figures_of_](Progress&) -> Result<Measured> {
        const auto begun = Clock::now();
        const QualityFigures figures = measure(*document->view(of));
        return Measured{figures, Clock::now() - begun};
      });
}

bool QualityMonitor::take() {
  const auto before = latest_;
  const std::string error_before = error_;
  while (auto done = worker_.take()) {
    latest_.reset();
    error_ = *done ? std::string() : done->error().sentence();
    if (!*done) continue;
    latest_ = (*done)->figures;
    rested_ = Clock::now() + share_of_rest * (*done)->took;
  }
  return latest_ != before || error_ != error_before;
}

bool QualityMonitor::update() {
  const bool changed = take();
  if (next_ && !worker_.busy() && Clock::now() >= rested_) measure();
  return changed;
}

std::optional<double> QualityMonitor::rest_seconds() const {
  if (!next_ || worker_.busy()) return std::nullopt;
  return std::max(0.0, std::chrono::duration<double>(rested_ - Clock::now()).count());
}

void QualityMonitor::finish() {
  while (next_ || worker_.busy()) {
    if (!worker_.busy()) measure();
    worker_.finish();
  }
  take();
}

}  // namespace homolog
