#include "app/editor/update/commands/tool_commands.h"

#include "app/editor/update/commands/spelling.h"
#include "app/editor/update/controls.h"

namespace homolog {

namespace {

constexpr std::array tool_names{"pull",     "grab",      "slide",   "relax", "place",
                                "landmark", "stiffness", "confirm", "ruler", "template landmark"};
constexpr std::array paint_names{"factor", "region", "smooth", "fill"};
constexpr std::array fill_names{"region", "curvature"};
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

void SetSigma::spell(Fields& line) {
  line.member("sigma_mm", sigma_mm);
}
void SetSigma::run(EditorState& state) const {
  set_sigma(state, sigma_mm);
}

void SetRelaxStrength::spell(Fields& line) {
  line.member("strength", strength);
}
void SetRelaxStrength::run(EditorState& state) const {
  state.relax_strength = strength;
}

void MoveThroughSpace::spell(Fields& line) {
  line.member("through", through);
}
void MoveThroughSpace::run(EditorState& state) const {
  state.through_space = through;
}

void SetBrush::spell(Fields& line) {
  line.member("radius_mm", brush.radius_mm);
  spell_choice(line, "paints", paint_names, brush.paints);
  line.member("region", brush.region);
  line.member("erases", brush.erases);
  spell_choice(line, "fill_by", fill_names, brush.fill_by);
  line.member("fill_tolerance_per_mm", brush.fill_tolerance_per_mm);
  line.member("stiffness_factor", brush.stiffness_factor);
  line.member("soft", brush.soft);
  line.member("hold", brush.hold);
}
void SetBrush::run(EditorState& state) const {
  state.brush = brush;
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

void NameTemplateLandmark::spell(Fields& line) {
  line.member("name", name);
}
void NameTemplateLandmark::run(EditorState& state) const {
  state.template_landmark = name;
}

void TypeRegion::spell(Fields& line) {
  line.member("name", name);
}
void TypeRegion::run(EditorState& state) const {
  state.new_region = name;
}

void NameRegion::spell(Fields& line) {
  std::optional<std::string> name, to;
  if (naming) {
    name = naming->rename.name;
    to = naming->rename.to;
  }
  line.or_null("name", name);
  line.or_null("to", to);
  if (line.reads() && name) naming = RegionNaming{{*name, to.value_or("")}, true};
}
void NameRegion::run(EditorState& state) const {
  state.renaming = naming;
}

void ChangeNumber::spell(Fields& line) {
  std::optional<std::string> control;
  std::optional<double> value;
  if (number) {
    control = number->control;
    value = number->value;
  }
  line.or_null("control", control);
  line.or_null("value", value);
  if (line.reads() && control && value) number = PanelEdit{*control, *value};
}
void ChangeNumber::run(EditorState& state) const {
  state.panel_edit = number;
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

void SetFit::spell(Fields& line) {
  spell_fit(line, fit);
}
void SetFit::run(EditorState& state) const {
  state.fit_settings = fit;
}

void SetTemplate::spell(Fields& line) {
  spell_template(line, settings);
}
void SetTemplate::run(EditorState& state) const {
  state.template_settings = settings;
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
