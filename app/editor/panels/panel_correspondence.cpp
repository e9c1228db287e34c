#include <algorithm>
#include <cmath>

#include "app/editor/panels/sections.h"
#include "app/editor/panels/ui_context.h"
#include "app/editor/scene/mesh_colouring.h"
#include "app/editor/update/tools/tool.h"
#include "app/editor/widgets/widgets.h"

namespace homolog {

namespace {

/// A swatch and a name each, side by side as far as they fit.
void draw_names(const Theme& theme, const Legend& legend) {
  const float side = theme.px(10), row = theme.px(18), left = ImGui::GetCursorScreenPos().x;
  const float right = left + ImGui::GetContentRegionAvail().x;
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  ImVec2 at = ImGui::GetCursorScreenPos();
  for (std::size_t i = 0; i < legend.names.size(); ++i) {
    const std::string name = shortened_among(legend.names[i], legend.names, right - left - side - theme.px(4));
    const float width = side + theme.px(4) + ImGui::CalcTextSize(name.c_str()).x;
    if (at.x > left && at.x + width > right) at = {left, at.y + row};
    const auto& [r, g, b] = legend.colours[i];
    colour_swatch(draw, theme, {at.x, at.y + (row - side) / 2}, side, ImGui::ColorConvertFloat4ToU32({r, g, b, 1}));
    text_at(draw, {at.x + side + theme.px(4), std::floor(at.y + (row - ImGui::GetFontSize()) / 2)}, palette::dim, name);
    at.x += width + theme.px(12);
  }
  ImGui::Dummy({right - left, at.y + row - ImGui::GetCursorScreenPos().y});
}

void draw_scale(const Theme& theme, const Legend& legend) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x;
  ImGui::Dummy({width, theme.px(26)});
  draw_legend_scale(*ImGui::GetWindowDrawList(), theme, legend, at, width, palette::dim);
}

}  // namespace

void draw_legend_scale(ImDrawList& draw, const Theme& theme, const Legend& legend, ImVec2 at, float width_px,
                       ImU32 colour) {
  const float bar = theme.px(6);
  const auto at_step = [&](std::size_t i) {
    const auto& [r, g, b] = legend.colours[i];
    return ImGui::ColorConvertFloat4ToU32({r, g, b, 1});
  };
  const std::size_t parts = legend.colours.size() - 1;
  for (std::size_t i = 0; i < parts; ++i) {
    const auto x = [&](std::size_t k) {
      return std::round(at.x + width_px * static_cast<float>(k) / static_cast<float>(parts));
    };
    draw.AddRectFilledMultiColor({x(i), at.y}, {x(i + 1), at.y + bar}, at_step(i), at_step(i + 1), at_step(i + 1),
                                 at_step(i));
  }
  const float y = at.y + bar + theme.px(3);
  const float middle = text_size(theme.small, legend.middle).x, high = text_size(theme.small, legend.high).x;
  text_at(draw, theme.small, {at.x, y}, colour, legend.low);
  text_at(draw, theme.small, {std::round(at.x + (width_px - middle) / 2), y}, colour, legend.middle);
  text_at(draw, theme.small, {at.x + width_px - high, y}, colour, legend.high);
}

void draw_colouring_legend(const UiContext& ui, Colouring colouring) {
  const Legend legend = colouring_legend(ui.shown(), colouring);
  if (legend.names.empty())
    draw_scale(ui.theme, legend);
  else
    draw_names(ui.theme, legend);
  if (legend.has_confirmed) draw_names(ui.theme, {"", "", "", {{1, 1, 1}}, {"confirmed"}});
  if (legend.has_outliers) draw_names(ui.theme, {"", "", "", {outlier_grey}, {"the scan lacks this part"}});
}

namespace {

/// What the colours of the mesh show, with their legend.
void draw_colour_choice(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  std::vector<std::string> names, tips;
  for (const ColouringKind& kind : colouring_kinds()) {
    names.emplace_back(kind.name);
    tips.emplace_back(kind.tip);
  }
  // It has its place also where it is not known, so that nothing moves when it is.
  std::vector<std::string> refusals(names.size());
  if (!ui.state.found.confidence)
    refusals[static_cast<std::size_t>(Colouring::confidence)] =
        "Snap the mesh to the image first. It is known until the mesh changes.";
  if (!why_not_scored(ui).empty())
    refusals[static_cast<std::size_t>(Colouring::score)] = "Choose a model in the section Score first.";
  const Colouring shown = shown_colouring(ui.state);
  const bool brush = is_brush(ui.state.hand.tool);
  int colouring = static_cast<int>(shown);
  caption(theme, "Colours of the mesh");
  if (choice(theme, "overlay", names, colouring,
             {.tips = tips,
              .refusal =
                  brush ? "While you hold a brush, the mesh shows what it paints. Doubt stays while you confirm." : "",
              .refusals = refusals}))
    out.send(ChooseColouring{static_cast<Colouring>(colouring)});
  draw_colouring_legend(ui, shown);
  if (ui.state.preferences.show.glyphs) {
    double spacing_mm = ui.state.look.glyph_spacing_mm;
    bool released = false;
    const double organ_mm = ui.state.look.organ_mm;
    if (slider(theme, "Glyph spacing", spacing_mm, {organ_mm / 50, organ_mm / 2, "%.1f", "mm", true},
               "Smallest distance between two glyphs, on the template", released))
      out.send(SpaceGlyphs{spacing_mm});
  }
}

/// Figures of the mesh; those of faults lead to the next one.
void draw_quality(const UiContext& ui, const QualityFigures& q, Outbox& out) {
  const Theme& theme = ui.theme;
  figure(theme, "Volume", format("%.2f ml", q.volume_ml), "Volume inside the mesh. Openings count as closed flat");
  figure(theme, "Edge stretch", format("%.2f to %.2f, median %.2f", q.stretch_low, q.stretch_high, q.stretch_median),
         "Edge length divided by that of the placed template. 90 % of the edges lie between the first two "
         "numbers");
  figure(theme, "Edges", format("%.2f mm \xc2\xb1 %.0f %%", q.edge_mean_mm, 100 * q.edge_cv),
         "Mean edge length and its standard deviation");
  figure(theme, "Six neighbours", format("%.0f %%", 100 * q.regular_share),
         "Share of the vertices that have six neighbours");
  const auto faults = [&](const char* label, const std::string& value, const char* tip, FindingKind kind, bool any,
                          ImU32 bad) {
    if (!any)
      figure(theme, label, value, tip, palette::good);
    else if (figure_link(theme, label, value, std::string(tip) + ". Click to go to the next one", bad))
      out.send(ShowFinding{kind});
  };
  const auto any_finding = [&](FindingKind kind) {
    return std::any_of(q.findings.begin(), q.findings.end(), [&](const Finding& one) { return one.kind == kind; });
  };
  faults("Smallest angle", format("%.1f\xc2\xb0", q.min_angle_deg),
         "Smallest angle of all triangles. Below 10\xc2\xb0 a triangle counts as thin, unless it is so in the template",
         FindingKind::thin, any_finding(FindingKind::thin), palette::amber);
  const char* doubt_tip =
      "How far from its place a vertex may lie, as the last fit found: the mean, and the largest. Nine in ten lie "
      "within "
      "about 1.44 times this";
  if (q.doubt_mean_mm)
    faults("Doubt", format("%.1f mm, at most %.1f mm", *q.doubt_mean_mm, q.doubt_max_mm), doubt_tip,
           FindingKind::doubtful, any_finding(FindingKind::doubtful), palette::amber);
  else
    figure(theme, "Doubt", "not known", doubt_tip);
  figure(theme, "Moved", format("%.1f mm, at most %.1f mm", q.moved_mean_mm, q.moved_max_mm),
         "How far vertices have moved since placement and warp: the mean, and the largest");
  faults("Turned triangles", format("%zu", q.turned),
         "Triangles that are turned over: the normal is more than 90\xc2\xb0 from where the template has it",
         FindingKind::turned, q.turned > 0, palette::bad);
  faults("Intersecting pairs", format("%zu%s", q.intersecting, q.all_intersecting ? "" : "+"),
         "Pairs of triangles that pass through each other", FindingKind::intersecting, q.intersecting > 0,
         palette::bad);
}

}  // namespace

void draw_correspondence_section(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  if (!ui.has_shape()) {
    explanation(theme, ui.structure() != nullptr ? ui.needs_shape()
                                                 : "Load a template first (Template). Then this section shows whether "
                                                   "the mesh keeps its correspondence.");
    return;
  }
  draw_colour_choice(ui, out);
  if (!ui.work.quality.latest())
    return explanation(theme, ui.work.quality.error().empty() ? "Measuring…" : ui.work.quality.error());
  draw_quality(ui, *ui.work.quality.latest(), out);
  draw_refinement(ui, out);
}

}  // namespace homolog
