#include <utility>

#include "core/case/action.h"
#include "core/case/held_landmarks.h"

namespace homolog {

namespace {

Result<void> check_mesh(const Document& document) {
  if (document.the_template == nullptr) return fail("", "There is no template yet; load one first.");
  if (!document.has_shape()) return fail("", "This frame has no mesh yet; start it from another frame.");
  return {};
}

}  // namespace

Result<Updated> update(const Document& document, const Action& action, Deformer& deformer, Pass pass) {
  const auto apply = [&](const auto& one) -> Result<Updated> {
    const auto& kind = action_kind(one);
    if (kind.needs_mesh)
      if (auto ready = check_mesh(document); !ready) return fail(ready.error());
    Edit edit{document, document, deformer, pass};
    auto report = kind.apply(one, edit);
    if (!report) return fail(report.error());
    settle_landmarks(document, edit.after);
    return Updated{std::move(edit.after), std::move(*report)};
  };
  return std::visit(apply, action);
}

std::string action_name(const Action& action) {
  return std::visit([](const auto& one) { return action_kind(one).name(one); }, action);
}

}  // namespace homolog
