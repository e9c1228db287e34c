#include <cmath>

#include "app/editor/panels/sections.h"
#include "app/editor/panels/ui_context.h"
#include "app/editor/update/tools/tool.h"
#include "app/editor/widgets/widgets.h"
#include "core/deform/stroke_kinds.h"
#include "core/mesh/mesh_quality.h"
#include "core/solve/shape_solver.h"

namespace homolog {

namespace {

void draw_sigma(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const auto& presets = ui.state.hand.sigma_presets_mm;
  int chosen = ui.state.hand.wheel_sigma_mm ? -1 : static_cast<int>(ui.state.hand.sigma_preset);
  const auto label = [&](std::size_t i) { return format("%zu   %.1f mm", i + 1, presets[i]); };
  caption(theme, "Width of a stroke");
  if (choice(theme, "sigma", {label(0), label(1), label(2)}, chosen,
             {.tips = {"Small: a spot (key 1, also while dragging)", "Medium: a part of the organ (key 2)",
                       "Large: a whole end of the organ (key 3)"},
              .refusal = ui.needs_shape()}))
    out.send(ChooseSigma{static_cast<std::size_t>(chosen)});
  double sigma_mm = ui.state.hand.sigma_mm();
  bool released = false;
  if (slider(theme, "Width \xcf\x83", sigma_mm, {smallest_sigma_mm, 100, "%.1f", "mm", true},
             "How wide a stroke is. This slider changes the chosen preset. The wheel during a drag does not", released,
             ui.needs_shape()))
    out.send(SetSigma{sigma_mm});
}

/// A slider whose value belongs to the case.
void case_slider(const UiContext& ui, Outbox& out, const char* label, double committed, const SliderRange& range,
                 const std::string& tip, const std::function<Action(double)>& action_for) {
  CaseNumber number(ui, label, committed);
  bool released = false;
  const bool changed = slider(ui.theme, label, number.value, range, tip, released, ui.needs_shape());
  number.settle(changed, released, action_for, out);
}

/// Which region the brush paints: the first one until another is chosen. True where that changed.
bool draw_region_to_paint(const UiContext& ui, BrushSettings& brush) {
  const auto& list = ui.structure()->paint.regions->list;
  if (list.empty()) {
    explanation(ui.theme, "Add a region first (Template, Regions).");
    return false;
  }
  std::vector<std::string> names;
  for (const Region& region : list) names.push_back(region.name);
  names.emplace_back("Erase (no region, factor 1)");
  const int erase = static_cast<int>(list.size());
  const auto found = std::find(names.begin(), names.end() - 1, brush.region);
  int chosen = brush.erases ? erase : found == names.end() - 1 ? 0 : static_cast<int>(found - names.begin());
  if (!combo(ui.theme, "region", names, chosen)) return false;
  brush.erases = chosen == erase;
  if (!brush.erases) brush.region = names[chosen];
  return true;
}

/// What a touch of the stiffness brush does; true where that changed.
bool draw_paints(const UiContext& ui, BrushSettings& brush) {
  const Theme& theme = ui.theme;
  bool released = false, changed = false;
  int paints = static_cast<int>(brush.paints);
  caption(theme, "The brush paints");
  if (choice(theme, "paints", {"Factor", "Region", "Smooth", "Fill"}, paints,
             {.tips = {"Paints a stiffness factor", "Paints a region, with its factor. Alt erases",
                       "Smooths the stiffness",
                       "Fills the connected part under the pointer. Alt takes it out of its region"}})) {
    brush.paints = static_cast<BrushPaints>(paints);
    changed = true;
  }
  if (brush.paints == BrushPaints::region || brush.paints == BrushPaints::fill)
    changed |= draw_region_to_paint(ui, brush);
  if (brush.paints == BrushPaints::factor) {
    changed |= slider(theme, "Paints factor", brush.stiffness_factor, {0.1, 50, "%.1f", "\xc3\x97", true},
                      "Stiffness relative to the base. Below 1 is softer: it follows a stroke closely. Above 1 is "
                      "stiffer: it keeps its shape. Alt paints 1",
                      released);
    slider_ends(theme, "soft", "stiff");
  }
  if (brush.paints == BrushPaints::factor || brush.paints == BrushPaints::region) {
    double soft = 100 * brush.soft;
    changed |= slider(theme, "Soft edge", soft, {0, 100, "%.0f", "%", false},
                      "The outer part of the radius, where the brush fades out", released);
    brush.soft = soft / 100;
  }
  if (brush.paints == BrushPaints::fill) {
    caption(theme, "Fill what is connected by");
    int by = static_cast<int>(brush.fill_by);
    if (choice(theme, "fill by", {"Region", "Curvature"}, by,
               {.tips = {"Everything connected in the same region",
                         "The same, but only where the surface is curved alike"}})) {
      brush.fill_by = static_cast<FillRegion::By>(by);
      changed = true;
    }
    if (brush.fill_by == FillRegion::By::curvature)
      changed |= slider(theme, "Tolerance", brush.fill_tolerance_per_mm, {0.005, 0.5, "%.3f", "/mm", true},
                        "How far the mean curvature may differ from that under the pointer", released);
  }
  return changed;
}

void draw_brush(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  BrushSettings brush = ui.state.hand.brush;
  bool released = false, changed = false;
  changed |= slider(theme, "Brush radius", brush.radius_mm,
                    {0.008 * ui.state.look.organ_mm, 0.8 * ui.state.look.organ_mm, "%.1f", "mm", true},
                    "Radius of the stiffness brush and of Confirm", released);
  if (ui.state.hand.tool == MouseTool::stiffness) {
    changed |= draw_paints(ui, brush);
  } else {
    caption(theme, "The brush");
    int frees = brush.hold ? 0 : 1;
    changed |= choice(theme, "confirm", {"Hold", "Free"}, frees,
                      {.tips = {"Later edits do not move what you paint", "Later edits move what you paint again"}});
    brush.hold = frees == 0;
  }
  if (changed) out.send(SetBrush{brush});
}

void draw_scheme(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const Document& document = *ui.snapshot().document;
  int scheme = static_cast<int>(document.scheme);
  caption(theme, "How edits are solved");
  if (choice(theme, "scheme", {"Anchored", "Paper", "Raw"}, scheme,
             {.tips = {"An edit never takes back an earlier one. The default",
                       "The scheme of the paper, word for word: every solve pulls the mesh back towards the template",
                       "No optimisation: vertices move by the falloff of the stroke alone"}}))
    out.apply(SetScheme{static_cast<Scheme>(scheme), document.paper_events});
  if (document.scheme == Scheme::paper)
    case_slider(ui, out, "Mouse events", document.paper_events, {1, 100, "%.0f", "", true, true},
                "The number of mouse events in one stroke. The mesh is solved once for each", [](double value) {
                  return SetScheme{Scheme::paper, static_cast<int>(std::lround(value))};
                });
}

}  // namespace

void draw_deform_section(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  draw_sigma(ui, out);
  if (!ui.has_shape()) return;
  const ToolKind& tool = kind_of(ui.state.hand.tool);
  if (tool.stroke && kind_of_stroke(*tool.stroke).is_dab()) {
    double strength = 100 * ui.state.hand.relax_strength;
    bool released = false;
    if (slider(theme, "Strength", strength, {0, 100, "%.0f", "%", false},
               "How far each dab brings the mesh back towards the template's shape", released))
      out.send(SetRelaxStrength{strength / 100});
  }
  if (is_brush(tool.tool)) draw_brush(ui, out);
  draw_snap(ui, out);
  const ShapeView shown = ui.shown();
  const Document& committed = *ui.snapshot().document;
  case_slider(ui, out, "Stiffness", active_structure(ui.state, committed)->paint.base, {0.1, 200, "%.1f", "", true},
              "Stiffness w of the whole surface. A stiffer surface spreads an edit wider",
              [](double value) { return SetStiffnessBase{value}; });
  const double edge_mm = mean_edge_mm(*shown.the_template().topology, *shown.shape.reference);
  figure(theme, "An edit spreads over", format("%.1f mm", stiffness_length_mm(shown.paint().base, edge_mm)),
         "The stiffness as a length: mean edge of the mesh \xc3\x97 \xe2\x88\x9a(3w)");
  case_slider(ui, out, "Even spacing", 100 * committed.even_spacing, {0, 100, "%.0f", "%", false},
              "Keeps vertices evenly spread during an edit. They may then slide along the surface",
              [](double value) { return SetEvenSpacing{value / 100}; });
  bool through = ui.state.hand.through_space;
  const bool sheets = shown.the_template().topology->components() > 1;
  if (toggle(theme, "Through space", through, "A stroke also moves other sheets of the mesh that lie near",
             sheets ? "" : "This mesh has one sheet only."))
    out.send(MoveThroughSpace{through});
  draw_scheme(ui, out);
  draw_model_help(ui, out);
  figure(theme, "Edits of the mesh", format("%d", shown.shape.strokes),
         "Strokes, fits and snaps since the mesh was placed");
  figure(theme, "Last solve", format("%.2f ms", ui.snapshot().solver_ms), "Time to compute the last edit");
}

}  // namespace homolog
