#include "core/case/actions/history_marks.h"

#include "core/case/actions/fields.h"

namespace homolog {

namespace {

constexpr const char* not_true = "\"undo\" and \"redo\" take true";

}  // namespace

const ActionKind<Note>& action_kind(const Note&) {
  static constexpr ActionKind<Note> kind{
      .key = "note",
      .example = R"({"note":"a first stroke"})",
      .meaning = "a remark",
      .role = LineRole::note,
      .needs_mesh = false,
      .name = [](const Note&) -> std::string { return "note"; },
      .spell = [](Fields& line, Note& note) { line.member("note", note.text); },
      .apply = [](const Note&, Edit&) -> Result<EditReport> { return EditReport{}; }};
  return kind;
}

const ActionKind<Undo>& action_kind(const Undo&) {
  static constexpr ActionKind<Undo> kind{
      .key = "undo",
      .example = R"({"undo":true})",
      .meaning = "takes the last step back",
      .role = LineRole::undo,
      .needs_mesh = false,
      .name = [](const Undo&) -> std::string { return "undo"; },
      .spell = [](Fields& line, Undo&) { line.constant("undo", true, not_true); },
      .apply = [](const Undo&, Edit&) -> Result<EditReport> { return fail("undo", "belongs to the session"); }};
  return kind;
}

const ActionKind<Redo>& action_kind(const Redo&) {
  static constexpr ActionKind<Redo> kind{
      .key = "redo",
      .example = R"({"redo":true})",
      .meaning = "does the step again that was taken back last",
      .role = LineRole::redo,
      .needs_mesh = false,
      .name = [](const Redo&) -> std::string { return "redo"; },
      .spell = [](Fields& line, Redo&) { line.constant("redo", true, not_true); },
      .apply = [](const Redo&, Edit&) -> Result<EditReport> { return fail("redo", "belongs to the session"); }};
  return kind;
}

}  // namespace homolog
