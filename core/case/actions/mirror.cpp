#include "core/case/actions/mirror.h"

#include "core/case/actions/fields.h"
#include "core/case/placing.h"
#include "core/mesh/mirror.h"

namespace homolog {

namespace {

Result<EditReport> apply_mirror(const MirrorTemplate&, Edit& edit) {
  const Document& before = edit.before;
  auto made = make_template(mirrored(to_mesh_file(*before.the_template)), before.the_template->source);
  if (!made) return fail(made.error());
  edit.after.the_template = *made;
  for (auto& [frame, shape] : edit.after.shapes) {
    shape.confirmed.reset();
    start_anew(**made, shape);
    if (auto report = carry_to_landmarks(**made, before.landmark_pull, before.landmark_rule, shape); !report)
      return fail(report.error());
  }
  return EditReport{};
}

}  // namespace

const ActionKind<MirrorTemplate>& action_kind(const MirrorTemplate&) {
  static constexpr ActionKind<MirrorTemplate> kind{
      .key = "mirror",
      .example = R"({"mirror":"sagittal"})",
      .meaning = "goes on with the template of the other side",
      .name = [](const MirrorTemplate&) -> std::string { return "mirror"; },
      .spell = [](Fields& line,
                  MirrorTemplate&) { line.constant("mirror", "sagittal", "\"mirror\" is not \"sagittal\""); },
      .apply = apply_mirror};
  return kind;
}

}  // namespace homolog
