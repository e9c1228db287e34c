#include "app/editor/update/commands/template_commands.h"

#include "app/editor/update/commands/spelling.h"
#include "app/editor/update/editing.h"
#include "core/mesh/voxels/isosurface.h"

namespace homolog {

void MakeTemplate::spell(Fields& line) {
  spell_value(line, "", settings);
  std::optional<Vec3> from, to;
  if (axis) {
    from = axis->from;
    to = axis->to;
  }
  line.optional("axis_from", from);
  line.optional("axis_to", to);
  if (from && to) axis = Ruler{*from, *to};
}
void MakeTemplate::run(Editing& editing) const {
  const auto& labels = editing.shown.labels();
  if (!labels.volume) return;
  EditorState& state = editing.state;
  TemplateSettings chosen = settings;
  if (chosen.label == 0 && !labels.values.empty()) chosen.label = labels.values.front();
  chosen.mask.label = chosen.tube_options.label = chosen.all_labels ? every_label : chosen.label;
  chosen.mask.frame = chosen.tube_options.frame = frame_of_map(*labels.volume, editing.shown.document().frame);
  chosen.tube_options.outer_label = chosen.outer_label != 0 ? std::optional<int>(chosen.outer_label) : std::nullopt;
  if (axis) chosen.tube_options.base_and_apex = {axis->from, axis->to};
  state.look.shown_stage.reset();
  state.look.making_shown = true;
  std::erase_if(chosen.faced.values, [&](int value) {
    return value == chosen.label || (value != 0 && std::ranges::find(labels.values, value) == labels.values.end());
  });
  FacedNames faced{{}, chosen.faced.kept};
  for (const int value : chosen.faced.values) {
    const auto name = labels.names.find(value);
    const bool is_named = name != labels.names.end() && name->second.find(',') == std::string::npos;
    faced.labels += faced.labels.empty() ? "" : ",";
    faced.labels += value == 0 ? "background" : is_named ? name->second : std::to_string(value);
  }
  editing.work.template_maker.start(labels.volume, labels.name, chosen, std::move(faced));
}

void CancelTemplate::run(Editing& editing) const {
  if (!editing.work.template_maker.busy()) return;
  editing.work.template_maker.cancel();
  editing.log.is_done(*this);
}

void UndoTemplate::run(Editing& editing) const {
  editing.work.template_maker.undo();
  editing.state.look.shown_stage.reset();
}

}  // namespace homolog
