#include "core/case/actions/frames.h"

#include <utility>

#include "core/case/actions/fields.h"
#include "core/case/placing.h"

namespace homolog {

namespace {

void spell_frame(Fields& line, SetFrame& action) {
  line.member("frame", action.frame);
  bool look = !line.reads() && !action.step;
  line.optional("look", look, look);
  action.step = !look;
}

Result<EditReport> apply_frame(const SetFrame& action, DocumentEdit& edit) {
  if (auto exists = check_frame(edit.before.scan, action.frame); !exists) return fail(exists.error());
  edit.after.frame = action.frame;
  for (const auto& structure : edit.before.structures)
    if (structure->shape(action.frame) == nullptr)
      edit.after.change(structure->id, [&](Structure& changed) {
        changed.set_shape(action.frame, shape_of_frame(changed, edit.before.frame, action.frame));
      });
  return EditReport{};
}

Result<EditReport> apply_copy(const StartFrameFrom& action, StructureEdit& edit) {
  const Shape* from = edit.before.shape(action.frame);
  if (from == nullptr) return fail("frame", std::to_string(action.frame) + " has no mesh to start from");
  Shape begun = *from;
  forget_edits(begun);  // all that was decided there is a guess here, and so is what a model did
  begun.strokes = from->strokes;
  begun.carried = begun.points;
  edit.after.set_shape(edit.document.frame, std::move(begun));
  return EditReport{};
}

}  // namespace

const ActionKind<SetFrame>& action_kind(const SetFrame&) {
  static constexpr ActionKind<SetFrame> kind{
      .key = "frame",
      .example = R"({"frame":3,"look":true})",
      .meaning =
          "shows a frame of a cine, counted from 0. Looking is not a step: there is nothing to undo, and redo "
          "stays possible. Without `look` (older versions) it is a step",
      .role = LineRole::step_or_look,
      .needs_mesh = false,
      .name = [](const SetFrame&) -> std::string { return "frame"; },
      .spell = spell_frame,
      .apply = apply_frame};
  return kind;
}

const ActionKind<StartFrameFrom>& action_kind(const StartFrameFrom&) {
  static constexpr ActionKind<StartFrameFrom> kind{
      .key = "start_frame_from",
      .example = R"({"start_frame_from":2})",
      .meaning = "gives the shown frame a copy of another frame's mesh",
      .needs_mesh = false,
      .name = [](const StartFrameFrom&) -> std::string { return "copy of a frame"; },
      .spell = [](Fields& line, StartFrameFrom& action) { line.member("start_frame_from", action.frame); },
      .apply = apply_copy};
  return kind;
}

}  // namespace homolog
