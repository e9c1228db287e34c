#include "app/editor/update/commands/tool_commands.h"

#include "app/editor/update/commands/spelling.h"
#include "app/editor/update/controls.h"

namespace homolog {

namespace {

constexpr std::array tool_names{"pull",     "grab",      "slide",   "relax", "place",
                                "landmark", "stiffness", "confirm", "ruler", "template landmark"};
constexpr std::array polarity_names{"automatic", "bright inside", "dark inside", "either"};

}  // namespace

void ChooseTool::spell(Fields& line) {
  spell_choice(line, "tool", tool_names, tool);
}
void ChooseTool::run(EditorState& state) const {
  if (tool == MouseTool::template_landmark && state.tool != tool) state.tool_before_naming = state.tool;
  state.tool = tool;
  const bool places = tool == MouseTool::place || tool == MouseTool::landmark;
  if (!places && !is_brush(tool)) return;
  state.wanted_section = places ? place_section : deform_section;
  state.preferences.sections_open[state.wanted_section] = true;
  ++state.section_wanted;
}

void ChooseSigma::spell(Fields& line) {
  line.member("preset", preset);
}
void ChooseSigma::run(EditorState& state, const ControlsContext&, Outbox& out) const {
  state.sigma_preset = std::min(preset, state.sigma_presets_mm.size() - 1);
  state.wheel_sigma_mm.reset();
  if (!state.drag) return;
  if (auto* stroke = std::get_if<StrokeDrag>(&*state.drag)) {
    stroke->stroke.sigma_mm = state.sigma_mm();
    if (const auto action = drag_action(state)) out.preview(action);
  }
}

void BrushRegion::spell(Fields& line) {
  line.member("region", region);
}
void BrushRegion::run(EditorState& state) const {
  state.tool = MouseTool::stiffness;
  state.brush.region = region;
  state.brush.erases = region.empty();
  if (state.brush.paints != BrushPaints::fill) state.brush.paints = BrushPaints::region;
}

void ChooseLandmark::spell(Fields& line) {
  line.member("name", name);
  line.optional("look_at_mm", look_at_mm);
}
void ChooseLandmark::run(EditorState& state) const {
  state.tool = MouseTool::landmark;
  state.landmark = name;
  if (look_at_mm) state.crosshair_mm = *look_at_mm;
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
  if (snap.show_confidence != state.snap.show_confidence) state.shows_confidence = snap.show_confidence;
  auto learned = std::move(state.snap.learned);
  state.snap = snap;
  state.snap.learned = std::move(learned);
}

void SnapWithStrokes::spell(Fields& line) {
  line.member("on", on);
}
void SnapWithStrokes::run(EditorState& state) const {
  state.snap.with_strokes = on;
  add_notice(state,
             on ? "Snap while dragging is on: what you pull or grab snaps to the image (Shift+N: off)."
                : "Snap while dragging is off.",
             false);
}

void Escape::run(EditorState& state, const ControlsContext& context, Outbox& out) const {
  if (state.drag)
    cancel_drag(state, out);
  else if (context.fits)
    out.send(CancelFits{});
  else if (state.ruler)
    state.ruler.reset();
  else if (state.finding)
    state.finding.reset();
  else
    state.maximised.reset();
}

}  // namespace homolog
