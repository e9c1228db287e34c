#include "app/editor/work/snaps.h"

#include <chrono>
#include <mutex>
#include <utility>

#include "app/editor/state/state.h"
#include "core/base/processes/guarded.h"

namespace homolog {

SnapOptions snap_options_of(const SnapSettings& settings) {
  SnapOptions options;
  options.strength = settings.strength;
  options.edges.reach_mm = settings.reach_mm;
  options.edges.polarity = settings.polarity;
  if (settings.polarity == Polarity::automatic) options.edges.appearance = settings.learned;
  return options;
}

Compute snap_compute(const SnapArea& region, const SnapSettings& settings) {
  return [region, options = snap_options_of(settings)](const Document& document,
                                                       const std::string& of) -> Result<std::optional<Action>> {
    const auto shown = shape_to("snap", document, of);
    if (!shown) return std::optional<Action>();
    auto edit = snap_shape(document.scan, *shown, region, options, SnapHolds::landmarks);
    return edit ? std::optional<Action>(std::move(edit->action)) : std::nullopt;
  };
}

/// What the session's thread and the window's share of one snap.
struct Snaps::Box {
  std::mutex mutex;
  Progress progress;
  bool running = true;
  std::optional<SnapFound> found;

  void end() {
    const std::lock_guard lock(mutex);
    running = false;
  }
  void put(std::optional<SnapFound> result) {
    const std::lock_guard lock(mutex);
    running = false;
    found = std::move(result);
  }
};

void Snaps::cancel() {
  if (box_) box_->progress.cancel();
}

bool Snaps::busy() const {
  if (!box_) return false;
  const std::lock_guard lock(box_->mutex);
  return box_->running;
}

std::optional<SnapFound> Snaps::take() {
  if (!box_) return std::nullopt;
  const std::lock_guard lock(box_->mutex);
  return std::exchange(box_->found, std::nullopt);
}

void Snaps::start(SessionThread& session, std::optional<SnapArea> region, const SnapSettings& settings, bool joined,
                  const std::string& of) {
  using Clock = std::chrono::steady_clock;
  cancel();
  box_ = std::make_shared<Box>();
  SnapOptions options = snap_options_of(settings);
  options.progress = &box_->progress;
  // Whatever becomes of the job, also where memory runs out: when it is gone the snap has ended.
  const auto ends = std::shared_ptr<Box>(box_.get(), [box = box_](Box*) { box->end(); });
  session.apply_computed(
      [box = box_, ends, region, options, holds = joined ? SnapHolds::landmarks : SnapHolds::all](
          const Document& document, const std::string& structure) -> Result<std::optional<Action>> {
        const auto begin = Clock::now();
        int strokes_before = 0;
        auto edit = guarded("The snap", [&]() -> Result<SnapEdit> {
          const auto shown = shape_to("snap", document, structure);
          if (!shown) return fail(shown.error());
          strokes_before = shown->shape.strokes;
          return snap_shape(document.scan, *shown, region, options, holds);
        });
        if (!edit) {
          box->put(std::nullopt);
          if (box->progress.cancelled()) return std::optional<Action>();
          return edit.error().subject.empty() ? fail(document.scan.source, edit.error().what) : fail(edit.error());
        }
        SnapFound found;
        found.points = edit->result.points;
        found.confidence = std::make_shared<const VertexScalars>(std::move(edit->result.confidence));
        found.mean_confidence = edit->result.mean_confidence;
        found.moved_mm = edit->result.moved_mm;
        found.doubtful = edit->result.doubtful;
        found.held = held_in_words(*edit);
        found.strokes = strokes_before + 1;
        found.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
        for (const std::string& warning : edit->result.warnings)
          found.warning += (found.warning.empty() ? "Snap: " : "; ") + warning;
        box->put(std::move(found));
        return std::optional<Action>(std::move(edit->action));
      },
      joined, of);
}

}  // namespace homolog
