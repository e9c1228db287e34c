#include "app/editor/work/propagator.h"

namespace homolog {

void Propagator::start(std::shared_ptr<const Document> document) {
  document_ = document;
  const std::string subject = document->volume_source;
  work_.start(subject, [document = std::move(document), subject](Progress& progress) -> Result<CineEdit> {
    PropagateOptions options;
    options.progress = &progress;
    auto edit = propagate_document(*document, options);
    if (!edit && edit.error().subject.empty()) return fail(subject, edit.error().what);
    return edit;
  });
}

void Propagator::cancel() {
  work_.cancel();
  document_.reset();
}

bool Propagator::still_of(const Document& now) const {
  const Document& then = *document_;
  if (now.volume != then.volume || now.the_template != then.the_template || now.stiffness != then.stiffness)
    return false;
  for (const auto& [frame, shape] : then.shapes) {
    const auto there = now.shapes.find(frame);
    if (there == now.shapes.end() || there->second.points != shape.points || there->second.confirmed != shape.confirmed)
      return false;
  }
  for (const auto& [frame, shape] : now.shapes)
    if (!then.shapes.contains(frame) && frame_is_known(shape)) return false;
  return true;
}

std::optional<Result<CineEdit>> Propagator::take() {
  auto done = work_.take();
  if (done) document_.reset();
  return done;
}

}  // namespace homolog
