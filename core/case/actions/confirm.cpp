#include "core/case/actions/confirm.h"

#include "core/case/actions/brush.h"
#include "core/case/actions/decided.h"
#include "core/case/actions/fields.h"

namespace homolog {

namespace {

void spell_confirm(Fields& line, Confirm& action) {
  Fields dab = line.object("confirm");
  dab.member("at", action.at);
  dab.member("radius_mm", action.radius_mm);
  dab.optional("hold", action.hold);
}

/// Released vertices are no longer held as pulled either.
void let_go(const Confirm& action, Shape& shape) {
  constexpr double hardly = 0.05;
  VertexScalars pulled = *shape.pulled;
  brush(*shape.points, action.at, action.radius_mm, 0, [&](Eigen::Index i, double) { pulled[i] = 0; });
  if (pulled.maxCoeff() < hardly) return forget_pulls(shape);
  shape.pulled = std::make_shared<const VertexScalars>(std::move(pulled));
}

Result<EditReport> apply_confirm(const Confirm& action, ShapeEdit& edit) {
  if (auto usable = check_brush(action.at, action.radius_mm, 0); !usable) return fail(usable.error());
  const auto& held = edit.before.shape.confirmed;
  auto confirmed = held ? std::make_shared<VertexScalars>(*held)
                        : std::make_shared<VertexScalars>(VertexScalars::Zero(edit.before.shape.points->rows()));
  const int touched = brush(*edit.before.shape.points, action.at, action.radius_mm, 0,
                            [&](Eigen::Index i, double) { (*confirmed)[i] = action.hold ? 1 : 0; });
  edit.after.confirmed = confirmed->any() ? confirmed : nullptr;
  if (!action.hold && edit.after.pulled) let_go(action, edit.after);
  EditReport report;
  report.message = touched == 0 ? nothing_covered
                                : std::to_string(touched) + (touched == 1 ? " vertex " : " vertices ") +
                                      (action.hold ? "confirmed." : "freed.");
  return report;
}

}  // namespace

const ActionKind<Confirm>& action_kind(const Confirm&) {
  static constexpr ActionKind<Confirm> kind{
      .key = "confirm",
      .example = R"({"confirm":{"at":[-21,20,-9],"radius_mm":10,"hold":true}})",
      .meaning = "holds (or frees) a region",
      .name = [](const Confirm& action) -> std::string { return action.hold ? "confirm" : "release"; },
      .spell = spell_confirm,
      .apply = apply_confirm};
  return kind;
}

}  // namespace homolog
