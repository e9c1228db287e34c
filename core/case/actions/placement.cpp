#include "core/case/actions/placement.h"

#include <type_traits>

#include "core/case/actions/fields.h"
#include "core/case/placing.h"

namespace homolog {

namespace {

/// R and P move along with the placement.
void move_placement(const Template& the_template, const Similarity& placement, Shape& shape) {
  const auto moved = [move = placement.after(shape.placement.inverse())](const Points& points) {
    return std::make_shared<const Points>(move.apply(points));
  };
  const bool warped = shape.reference != shape.placed;
  const bool edited = shape.points != shape.reference;
  for_each_member(shape_members, [&](const auto& member) {
    if constexpr (std::is_same_v<decltype(member.of), std::shared_ptr<const Points> Shape::*>) {
      auto& trace = shape.*member.of;
      if (moves_along(member.origin) && trace) trace = moved(*trace);
    }
  });
  shape.placement = shape.before_landmarks = placement;
  shape.placed = std::make_shared<const Points>(placement.apply(the_template.points));
  shape.reference = warped ? moved(*shape.reference) : shape.placed;
  shape.points = edited ? moved(*shape.points) : shape.reference;
  forget(Origin::fit, shape);  // the mesh has left it
}

}  // namespace

const ActionKind<SetPlacement>& action_kind(const SetPlacement&) {
  static constexpr ActionKind<SetPlacement> kind{
      .key = "placement",
      .example = R"({"placement":{"rotation":[1,0,0,0],"scale":1,"translation":[12,-40,310]}})",
      .meaning = "moves the mesh and its reference",
      .name = [](const SetPlacement&) -> std::string { return "placement"; },
      .spell = [](Fields& line, SetPlacement& action) { line.member("placement", action.placement); },
      .apply = [](const SetPlacement& action, ShapeEdit& edit) -> Result<EditReport> {
        const Template& the_template = edit.before.the_template();
        if (auto usable = check_placement(action.placement, the_template.points); !usable) return fail(usable.error());
        move_placement(the_template, action.placement, edit.after);
        return EditReport{};
      }};
  return kind;
}

}  // namespace homolog
