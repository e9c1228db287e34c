#include "app/editor/work/propagator.h"

#include <algorithm>

#include "core/assist/assist.h"

namespace homolog {

void Propagator::start(std::shared_ptr<const Document> document, std::string of) {
  document_ = document;
  of_ = of;
  const std::string subject = document->scan.source;
  work_.start(subject,
              [document = std::move(document), of = std::move(of), subject](Progress& progress) -> Result<CineEdit> {
                PropagateOptions options;
                options.progress = &progress;
                const auto shown = shape_to("propagate", *document, of);
                auto edit = shown ? propagate_shape(document->scan, *shown, options) : fail(shown.error());
                if (!edit && edit.error().subject.empty()) return fail(subject, edit.error().what);
                return edit;
              });
}

void Propagator::cancel() {
  work_.cancel();
  document_.reset();
}

bool Propagator::still_of(const Document& now) const {
  const Structure *was = document_->structure(of_), *is = now.structure(of_);
  if (was == nullptr || is == nullptr || now.scan.image != document_->scan.image ||
      is->the_template != was->the_template || is->paint.stiffness != was->paint.stiffness)
    return false;
  const auto unchanged = [&](const auto& one) {
    const auto& [frame, shape] = one;
    const Shape* there = is->shape(frame);
    return there != nullptr && there->points == shape->points && there->confirmed == shape->confirmed;
  };
  const auto still_unknown = [&](const auto& one) {
    return was->shape(one.first) != nullptr || !frame_is_known(*one.second);
  };
  return std::all_of(was->shapes.begin(), was->shapes.end(), unchanged) &&
         std::all_of(is->shapes.begin(), is->shapes.end(), still_unknown);
}

std::optional<Result<CineEdit>> Propagator::take() {
  auto done = work_.take();
  if (done) document_.reset();
  return done;
}

}  // namespace homolog
