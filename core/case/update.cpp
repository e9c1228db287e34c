#include <utility>

#include "core/case/action.h"
#include "core/case/held_landmarks.h"

namespace homolog {

namespace {

constexpr const char* no_template = "There is no template yet; load one first.";
constexpr const char* no_mesh = "This frame has no mesh yet; start it from another frame.";

/// The things that an action works on, and how.
struct Place {
  const Document& document;
  const std::string& of;
  Deformer& deformer;
  Pass pass;
};

/// Errors: no structure of that id, no mesh where one is needed.
Result<const Structure*> structure_to_edit(const Place& place, bool needs_mesh) {
  const Structure* structure = place.document.structure(place.of);
  if (structure == nullptr && place.of.empty()) return fail("", no_template);
  if (structure == nullptr) return fail("", "There is no structure \"" + place.of + "\".");
  if (needs_mesh && structure->shape(place.document.frame) == nullptr) return fail("", no_mesh);
  return structure;
}

/// The document after an edit of one structure.
Document with_structure(const Document& before, const Structure& old, Structure changed) {
  settle_landmarks(old, changed, before.frame);
  Document after = before;
  after.change(old.id, [&](Structure& structure) { structure = std::move(changed); });
  return after;
}

// Applies an action in its scope.

template <class A>
Result<Updated> done(const A& action, Result<EditReport> (*apply)(const A&, DocumentEdit&), const Place& place) {
  if (action_kind(action).needs_mesh)
    if (auto found = structure_to_edit(place, true); !found) return fail(found.error());
  Updated updated{place.document, {}};
  DocumentEdit edit{place.document, updated.document};
  auto report = apply(action, edit);
  if (!report) return fail(report.error());
  updated.report = std::move(*report);
  return updated;
}

template <class A>
Result<Updated> done(const A& action, Result<EditReport> (*apply)(const A&, StructureEdit&), const Place& place) {
  const auto found = structure_to_edit(place, action_kind(action).needs_mesh);
  if (!found) return fail(found.error());
  const Structure& before = **found;
  Structure after = before;
  StructureEdit edit{place.document, before, after};
  auto report = apply(action, edit);
  if (!report) return fail(report.error());
  return Updated{with_structure(place.document, before, std::move(after)), std::move(*report)};
}

template <class A>
Result<Updated> done(const A& action, Result<EditReport> (*apply)(const A&, ShapeEdit&), const Place& place) {
  const auto found = structure_to_edit(place, true);
  if (!found) return fail(found.error());
  const Structure& before = **found;
  const int frame = place.document.frame;
  const Shape& shape = *before.shape(frame);
  Shape after = shape;
  ShapeEdit edit{place.document, {before, shape, frame}, after, place.deformer, place.pass};
  auto report = apply(action, edit);
  if (!report) return fail(report.error());
  Structure changed = before;
  changed.set_shape(frame, std::move(after));
  return Updated{with_structure(place.document, before, std::move(changed)), std::move(*report)};
}

}  // namespace

Result<Updated> update(const Document& document, const std::string& of, const Action& action, Deformer& deformer,
                       Pass pass) {
  const Place place{document, of, deformer, pass};
  return std::visit(
      [&](const auto& one) {
        return std::visit([&](const auto apply) { return done(one, apply, place); }, action_kind(one).apply);
      },
      action);
}

bool works_on_structure(const Action& action) {
  return std::visit([](const auto& one) { return action_kind(one).apply.index() > 0; }, action);
}

std::string action_name(const Action& action) {
  return std::visit([](const auto& one) { return action_kind(one).name(one); }, action);
}

}  // namespace homolog
