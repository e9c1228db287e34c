#include "app/editor/update/commands/tool_commands.h"

#include <algorithm>

#include "app/editor/update/commands/spelling.h"
#include "app/editor/update/controls.h"
#include "app/editor/update/tools/tool.h"

namespace homolog {

namespace {

constexpr std::array polarity_names{"automatic", "bright inside", "dark inside", "either"};

}  // namespace

void ChooseTool::spell(Fields& line) {
  std::array<const char*, tool_kinds.size()> names{};
  std::transform(tool_kinds.begin(), tool_kinds.end(), names.begin(),
                 [](const ToolKind* kind) { return kind->log_name; });
  spell_choice(line, "tool", names, tool);
}
void ChooseTool::run(EditorState& state) const {
  if (tool == MouseTool::template_landmark && state.hand.tool != tool) state.hand.tool_before_naming = state.hand.tool;
  state.hand.tool = tool;
  const char* section = kind_of(tool).section;
  if (section == nullptr) return;
  state.wanted_section = section;
  state.preferences.sections_open[state.wanted_section] = true;
  ++state.section_wanted;
}

void ChooseSigma::spell(Fields& line) {
  line.member("preset", preset);
}
void ChooseSigma::run(EditorState& state, const ControlsContext&, Outbox& out) const {
  state.hand.sigma_preset = std::min(preset, state.hand.sigma_presets_mm.size() - 1);
  state.hand.wheel_sigma_mm.reset();
  if (!state.pointer.drag) return;
  if (auto* stroke = std::get_if<StrokeDrag>(&*state.pointer.drag)) {
    stroke->stroke.sigma_mm = state.hand.sigma_mm();
    if (const auto action = drag_action(state)) out.preview(action);
  }
}

void BrushRegion::spell(Fields& line) {
  line.member("region", region);
}
void BrushRegion::run(EditorState& state) const {
  state.hand.tool = MouseTool::stiffness;
  state.hand.brush.region = region;
  state.hand.brush.erases = region.empty();
  if (state.hand.brush.paints != BrushPaints::fill) state.hand.brush.paints = BrushPaints::region;
}

void ChooseLandmark::spell(Fields& line) {
  line.member("name", name);
  line.optional("look_at_mm", look_at_mm);
}
void ChooseLandmark::run(EditorState& state) const {
  state.hand.tool = MouseTool::landmark;
  state.hand.landmark = name;
  if (look_at_mm) state.look.crosshair_mm = *look_at_mm;
}

void SetSnap::spell(Fields& line) {
  line.member("strength", snap.strength);
  line.member("reach_mm", snap.reach_mm);
  spell_choice(line, "polarity", polarity_names, snap.polarity);
  line.member("with_strokes", snap.with_strokes);
  line.member("show_confidence", snap.show_confidence);
  line.member("learn", snap.learn);
}
void SetSnap::run(EditorState& state) const {
  if (snap.show_confidence != state.automatic.snap.show_confidence) state.look.shows_confidence = snap.show_confidence;
  auto learned = std::move(state.automatic.snap.learned);
  state.automatic.snap = snap;
  state.automatic.snap.learned = std::move(learned);
}

void SnapWithStrokes::spell(Fields& line) {
  line.member("on", on);
}
void SnapWithStrokes::run(EditorState& state) const {
  state.automatic.snap.with_strokes = on;
  add_notice(state,
             on ? "Snap while dragging is on: what you pull or grab snaps to the image (Shift+N: off)."
                : "Snap while dragging is off.",
             false);
}

void Escape::run(EditorState& state, const ControlsContext& context, Outbox& out) const {
  if (state.pointer.drag)
    cancel_drag(state, out);
  else if (context.fits)
    out.send(CancelFits{});
  else if (state.hand.ruler)
    state.hand.ruler.reset();
  else if (state.found.finding)
    state.found.finding.reset();
  else
    state.look.maximised.reset();
}

}  // namespace homolog
