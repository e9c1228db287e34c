#include "app/editor/work/contours/contour_fits.h"

#include <algorithm>
#include <mutex>
#include <utility>

#include "app/editor/state/label_map_layer.h"
#include "app/editor/work/snaps.h"
#include "core/adapt/labels/label_fit.h"
#include "core/base/processes/guarded.h"
#include "core/mesh/voxels/isosurface.h"

namespace homolog {

namespace {

/// The boundary of the label in hand.
Result<std::shared_ptr<const Boundary>> boundary_of(const ShapeView& shown, const ContourFitJob& job) {
  const Template& the_template = shown.the_template();
  const int frame = frame_of_map(*job.labels, shown.frame);
  const int label = job.fit.all_labels ? every_label : job.fit.label;
  const LabelFitOptions how{.closing_mm = job.fit.closing_mm,
                            .kept_closing_mm = closing_kept_with(the_template.source),
                            .largest_part = true};
  const MapLabel target{*job.labels, label, frame, job.known};
  auto boundary = boundary_to_fit(the_template, target, how, first_closing_mm(target, how), {});
  if (!boundary) return fail("The label map", boundary.error().what);
  return std::make_shared<const Boundary>(std::move(*boundary));
}

Result<FitEdit> fit_as_asked(const Document& document, const std::string& of, const ContourFitJob& job,
                             Progress* progress) {
  const auto shown = shape_to("fit", document, of);
  if (!shown) return fail(shown.error());
  BetweenContours between;
  if (job.between == BetweenCurves::image) {
    between.image = document.scan.image;
    between.snap = snap_options_of(job.snap);
  }
  if (job.between == BetweenCurves::label && job.labels) {
    auto boundary = boundary_of(*shown, job);
    if (!boundary) return fail(boundary.error());
    between.boundary = std::move(*boundary);
  }
  FitOptions options;
  options.rough = progress == nullptr;
  options.progress = progress;
  return fit_shape_to_contours(*shown, between, job.goes_on, options);
}

}  // namespace

Compute contour_compute() {
  return [](const Document& document, const std::string& of) -> Result<std::optional<Action>> {
    auto edit = fit_as_asked(document, of, ContourFitJob{.goes_on = true}, nullptr);
    return edit ? std::optional<Action>(std::move(edit->action)) : std::nullopt;
  };
}

/// What the session's thread and the window's share of one fit.
struct ContourFits::Box {
  std::mutex mutex;
  Progress progress;
  bool running = true;
  std::optional<ContoursFitted> found;

  void end() {
    const std::lock_guard lock(mutex);
    running = false;
  }
};

void ContourFits::cancel() {
  if (box_) box_->progress.cancel();
}

bool ContourFits::busy() const {
  if (!box_) return false;
  const std::lock_guard lock(box_->mutex);
  return box_->running;
}

double ContourFits::fraction() const {
  return box_ ? box_->progress.fraction() : 0;
}

std::optional<ContoursFitted> ContourFits::take() {
  if (!box_) return std::nullopt;
  const std::lock_guard lock(box_->mutex);
  return std::exchange(box_->found, std::nullopt);
}

void ContourFits::start(SessionThread& session, const ContourFitJob& job, bool joined, const std::string& of) {
  cancel();
  box_ = std::make_shared<Box>();
  // Whatever becomes of the job, also where memory runs out: when it is gone the fit has ended.
  const auto ends = std::shared_ptr<Box>(box_.get(), [box = box_](Box*) { box->end(); });
  session.apply_computed(
      [box = box_, ends, job](const Document& document, const std::string& id) -> Result<std::optional<Action>> {
        auto edit = guarded("The fit", [&] { return fit_as_asked(document, id, job, &box->progress); });
        if (box->progress.cancelled()) return std::optional<Action>();
        if (!edit) return fail(edit.error());
        const auto shown = document.view(id);
        ContoursFitted found{edit->action.points, shown->structure.contours, {}, edit->result.warnings};
        found.off = contour_distance(drawn_contours(*shown), {shown->the_template().topology, *edit->action.points});
        {
          const std::lock_guard lock(box->mutex);
          box->found = std::move(found);
        }
        return std::optional<Action>(std::move(edit->action));
      },
      joined, of);
}

}  // namespace homolog
