#include "app/editor/fitter.h"

#include <algorithm>
#include <utility>

namespace homolog {

namespace {

Result<Fitted> fitted(const Document& document, const Volume& labels, const FitSettings& settings, FitOptions options) {
  const Template& reference = *document.reference;
  const Shape& shape = document.shape();
  const int frame = std::min(document.frame, labels.frames - 1);
  auto boundary = label_boundary(labels, settings.label, frame, settings.closing_mm, reference.points.rows());
  if (!boundary) return fail(boundary.error());
  if (settings.as_placed) options.placement = shape.placement;
  options.landmarks = shape.landmarks;
  auto fit = fit_to_boundary(reference, *boundary, options);
  if (!fit) return fail(fit.error());
  Fitted done;
  done.fit = std::move(*fit);
  done.warnings = std::move(boundary->warnings);
  done.warnings.insert(done.warnings.end(), done.fit.warnings.begin(), done.fit.warnings.end());
  done.agreement = compare_meshes(done.fit.mesh, boundary->surface);
  done.doubtful = is_doubtful(done.agreement, *boundary);
  done.mirrored = !settings.as_placed && looks_mirrored(reference, *boundary);
  return done;
}

}  // namespace

void Fitter::start(std::shared_ptr<const Document> document, std::shared_ptr<const Volume> labels,
                   const FitSettings& settings) {
  document_ = document;
  box_ = std::make_shared<Box>();
  work_.start([=, box = box_, wake = wake_](Progress& progress) {
    FitOptions options;
    options.progress = &progress;
    options.show = [&](const Points& points) {
      {
        const std::lock_guard lock(box->mutex);
        box->step = std::make_shared<const Points>(points);
      }
      wake();
    };
    return fitted(*document, *labels, settings, std::move(options));
  });
}

void Fitter::cancel() {
  work_.cancel();
  document_.reset();
  box_ = std::make_shared<Box>();
}

std::shared_ptr<const Points> Fitter::take_step() {
  const std::lock_guard lock(box_->mutex);
  return std::exchange(box_->step, nullptr);
}

std::optional<Result<Fitted>> Fitter::take() {
  auto done = work_.take();
  if (done) document_.reset();
  return done;
}

}  // namespace homolog
