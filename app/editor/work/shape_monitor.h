#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "app/editor/work/worker.h"
#include "core/case/document.h"

namespace homolog {

/// Measures the shown mesh beside the window; the latest mesh posted wins. It rests between meshes that follow each
/// other closely, as during a drag. Called from the window's thread only.
template <class Figures>
class ShapeMonitor {
 public:
  /// Measures a structure of a document, by its id; it has a mesh there.
  using Measure = std::function<Figures(const Document&, const std::string& of)>;
  /// `wake` is called from the thread after every new result; `subject` begins the sentence of an error.
  ShapeMonitor(std::function<void()> wake, std::string subject, Measure measure)
      : subject_(std::move(subject)), figures_of_(std::move(measure)), worker_(std::move(wake)) {}
  /// Measures otherwise from now on; the figures so far are forgotten.
  void measure_by(Measure measure) {
    post(nullptr);
    figures_of_ = std::move(measure);
  }

  /// `of`: the structure; empty: the first. The figures so far are forgotten where they are of another structure, and
  /// where the document has no mesh of it (or is null). The same document again changes nothing.
  void post(std::shared_ptr<const Document> document, std::string of = {}) {
    if (document == posted_ && of == of_) return;
    const auto id_in = [](const auto& any, const std::string& id) {
      const Structure* structure = any ? any->structure(id) : nullptr;
      return structure != nullptr ? structure->id : std::string();
    };
    // The empty id is another structure's once the first one goes.
    const bool other = of != of_ || id_in(posted_, of_) != id_in(document, of);
    posted_ = document;
    const bool has_mesh = document && document->view(of);
    if (!has_mesh || other) forget();
    of_ = std::move(of);
    if (has_mesh) next_ = std::move(document);
  }
  /// The structure that was posted last; empty: the first.
  const std::string& of() const { return of_; }
  /// Takes in what was measured, and measures the mesh posted last when it has rested. True where the figures changed.
  bool update() {
    const bool changed = take();
    if (next_ && !worker_.busy() && Clock::now() >= rested_) measure();
    return changed;
  }
  /// Whether the mesh posted last is not measured yet.
  bool busy() const { return next_ != nullptr || worker_.busy(); }
  /// Seconds until it has rested; nothing where no mesh waits for that.
  std::optional<double> rest_seconds() const {
    if (!next_ || worker_.busy()) return std::nullopt;
    return std::max(0.0, std::chrono::duration<double>(rested_ - Clock::now()).count());
  }
  /// Returns the figures of the latest mesh that is measured; nothing before the first.
  const std::optional<Figures>& latest() const { return latest_; }
  /// Why the mesh posted last could not be measured; empty where it was.
  const std::string& error() const { return error_; }
  /// Waits until the mesh posted last is measured.
  void finish() {
    while (next_ || worker_.busy()) {
      if (!worker_.busy()) measure();
      worker_.finish();
    }
    take();
  }

 private:
  using Clock = std::chrono::steady_clock;
  /// A drag posts meshes faster than they are measured; this leaves the processor to drawing it.
  static constexpr int share_of_rest = 9;
  struct Measured {
    Figures figures;
    Clock::duration took{};
  };

  void forget() {
    worker_.cancel();
    next_.reset();
    latest_.reset();
    error_.clear();
    rested_ = {};
  }
  void measure() {
    worker_.queue(
        subject_,
        [document = std::exchange(next_, nullptr), of = of_, figures_of = figures_of_](Progress&) -> Result<Measured> {
          const auto begun = Clock::now();
          Figures figures = figures_of(*document, of);
          return Measured{std::move(figures), Clock::now() - begun};
        });
  }
  bool take() {
    const auto before = latest_;
    const std::string error_before = error_;
    while (auto done = worker_.take()) {
      latest_.reset();
      error_ = *done ? std::string() : done->error().sentence();
      if (!*done) continue;
      rested_ = Clock::now() + share_of_rest * (*done)->took;
      latest_ = std::move((*done)->figures);
    }
    return latest_ != before || error_ != error_before;
  }

  std::string subject_;
  Measure figures_of_;
  Worker<Measured> worker_;
  std::shared_ptr<const Document> posted_, next_;  ///< the last, and where it is not measured yet
  std::string of_;                                 ///< the id of their structure
  Clock::time_point rested_{};
  std::optional<Figures> latest_;
  std::string error_;
};

}  // namespace homolog
