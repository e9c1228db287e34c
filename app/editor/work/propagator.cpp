#include "app/editor/work/propagator.h"

#include <algorithm>

#include "core/assist/assist.h"
#include "core/structures/fitting/shared_in_case.h"

namespace homolog {

namespace {

/// Whether a structure has the meshes that a propagation started from.
bool is_as_it_was(const Structure* was, const Structure* is) {
  if (was == nullptr || is == nullptr || is->the_template != was->the_template ||
      is->paint.stiffness != was->paint.stiffness)
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

}  // namespace

void Propagator::start(std::shared_ptr<const Document> document, std::vector<std::string> of) {
  document_ = document;
  of_ = of;
  const std::string subject = document->scan.source;
  work_.start(
      subject,
      [document = std::move(document), of = std::move(of), subject](Progress& progress) -> Result<StructureCines> {
        StructureCines all;
        for (const std::string& id : of) {
          Progress own(progress, 1 / static_cast<double>(of.size()));
          PropagateOptions options;
          options.progress = &own;
          const auto shown = shape_to("propagate", *document, id);
          auto edit = shown ? propagate_shape(document->scan, *shown, options) : fail(shown.error());
          if (!edit) return fail(edit.error().subject.empty() ? subject : edit.error().subject, edit.error().what);
          all.emplace_back(shown->structure.id, std::move(*edit));
        }
        std::vector<CarriedStructure> carried;
        for (auto& [id, edit] : all) carried.push_back({id, edit.actions});
        share_carried(*document, carried);
        return all;
      });
}

void Propagator::cancel() {
  work_.cancel();
  document_.reset();
}

bool Propagator::still_of(const Document& now) const {
  return now.scan.image == document_->scan.image && std::all_of(of_.begin(), of_.end(), [&](const std::string& id) {
           return is_as_it_was(document_->structure(id), now.structure(id));
         });
}

std::optional<Result<StructureCines>> Propagator::take() {
  auto done = work_.take();
  if (done) document_.reset();
  return done;
}

}  // namespace homolog
