#include <algorithm>
#include <cmath>

#include "app/editor/panels/sections.h"
#include "app/editor/panels/ui_context.h"
#include "app/editor/scene/mesh_colouring.h"
#include "app/editor/widgets/widgets.h"

// How far the shown mesh is from a model.

namespace homolog {

namespace {

/// Signed, with a minus as long as the plus.
std::string in_sigma(double value) {
  return (value < 0 ? "\xe2\x88\x92" : "+") + format("%.2f \xcf\x83", std::abs(value));
}

void draw_scored_by(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const Scoring& scoring = ui.state.scoring;
  int by_file = scoring.by_file ? 1 : 0;
  if (choice(theme, "score model", {"Study's", "File's"}, by_file,
             {.tips = {"Scores against the model of the open study's other cases",
                       "Scores against the model of a file: .h5 or .h5.json of Homolog, scalismo or statismo"}}))
    out.send(ScoreByFile{by_file == 1});
  if (!scoring.by_file) return;
  const float width = ImGui::GetContentRegionAvail().x;
  if (button(theme,
             scoring.of_file ? shortened(scoring.file.filename().string(), width - theme.px(16))
                             : "Choose the model\xe2\x80\xa6",
             "The file of the model. It must have the template's numbering, and is never changed", {}, width))
    out.send(ShowFileDialog{FilePurpose::open_score_model, {}});
}

/// A row with a bar from the middle: ±3σ to its ends.
void draw_coordinate(const Theme& theme, Eigen::Index mode, double value, ImU32 colour) {
  constexpr double most = 3;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, height = ImGui::GetTextLineHeight();
  figure(theme, format("Mode %d", static_cast<int>(mode) + 1).c_str(), in_sigma(value),
         "Where the mesh lies on this mode, in standard deviations of the training shapes. The bar ends at 3",
         std::abs(value) > most ? palette::amber : colour);
  const float middle = std::round(at.x + 0.5f * width), half = std::round(0.2f * width);
  const float top = at.y + height * 0.35f + theme.px(2), bottom = top + height * 0.4f;
  const float end = middle + half * static_cast<float>(std::clamp(value / most, -1.0, 1.0));
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  draw.AddRectFilled({middle - half, top}, {middle + half, bottom}, palette::raised, theme.px(2));
  draw.AddRectFilled({std::min(middle, end), top}, {std::max(middle, end), bottom},
                     std::abs(value) > most ? palette::amber : palette::accent, theme.px(2));
  draw.AddRectFilled({middle, top - theme.px(2)}, {middle + 1, bottom + theme.px(2)}, palette::dim);
}

void draw_farthest_vertex(const UiContext& ui, const ScoredShape& scored, ImU32 colour, Outbox& out) {
  if (!scored.z) return;
  const ShapeScore& score = *scored.score;
  Eigen::Index vertex = 0;
  scored.z->cwiseAbs().maxCoeff(&vertex);
  const double z = (*scored.z)[vertex];
  // The rows of a joint model's structure begin elsewhere; the z of a row is the same number.
  Eigen::Index row = 0;
  (score.z.array() - z).abs().minCoeff(&row);
  if (figure_link(
          ui.theme, "Farthest vertex", in_sigma(z),
          format("Vertex %d: how far it lies outside (above 0) or inside of the model's mean along its normal, "
                 "in standard deviations. Its interval of 95 %% goes from %s to %s. Click to go there",
                 static_cast<int>(vertex), in_sigma(score.z_low[row]).c_str(), in_sigma(score.z_high[row]).c_str()),
          colour))
    out.send(LookAt{scored.points->row(vertex)});
}

void draw_score_figures(const UiContext& ui, const ScoredShape& scored, Outbox& out) {
  const Theme& theme = ui.theme;
  const ShapeScore& score = *scored.score;
  const ShapeModel& model = *scored.model;
  // What is of a mesh that has moved since is shown faint until it is scored anew.
  const bool is_old = scored.points != ui.shown().shape.points || ui.work.scores.busy();
  const ImU32 colour = is_old ? palette::faint : palette::text;
  figure(theme, "Within the model", format("%.2f \xcf\x83", score.distance),
         format("Distance from the mean on all %d modes together, in standard deviations (Mahalanobis)",
                static_cast<int>(score.modes.size())),
         colour);
  figure(theme, "Beyond the model", format("%.2f mm", score.residual_mm),
         "What no mode makes: root mean square distance of the vertices from the nearest shape of the model", colour);
  const auto training = static_cast<int>(model.left_out_distances.size());
  if (score.percentile)
    figure(
        theme, "Percentile", format("%.0f %%", *score.percentile),
        format("Share of the %d training shapes that lie nearer to the mean, each measured by the model of the others",
               training),
        colour);
  else
    figure(theme, "Percentile", "\xe2\x80\x93",
           "The model does not say how far its training shapes lie. Make it of four or more with Homolog.",
           palette::faint);
  draw_farthest_vertex(ui, scored, colour, out);
  for (std::size_t k = 0; k < score.parts.size(); ++k)
    figure(theme, model.parts[k].name.c_str(),
           format("z %.2f \xcf\x83, %.2f mm", score.parts[k].z_rms, score.parts[k].residual_mm),
           "Root mean square of z over its vertices, in standard deviations, and what no mode makes of it", colour);
  constexpr Eigen::Index first_few = 5;
  for (Eigen::Index mode = 0; mode < std::min(first_few, score.modes.size()); ++mode)
    draw_coordinate(theme, mode, score.modes[mode], colour);
  Eigen::Index farthest = 0;
  if (score.modes.size() > first_few && score.modes.cwiseAbs().maxCoeff(&farthest) > 0 && farthest >= first_few)
    draw_coordinate(theme, farthest, score.modes[farthest], colour);
}

void draw_score_colours(const UiContext& ui, Outbox& out) {
  bool coloured = ui.state.look.colouring == Colouring::score;
  if (toggle(ui.theme, "Colour the mesh by z", coloured, kind_of(Colouring::score).tip,
             ui.state.scoring.z ? "" : "The model has no structure of this name."))
    out.send(ChooseColouring{coloured                              ? Colouring::score
                             : ui.document().structures.size() > 1 ? Colouring::structure
                                                                   : Colouring::vertex_hue});
  if (coloured && ui.state.scoring.z) draw_colouring_legend(ui, Colouring::score);
}

}  // namespace

std::string why_not_scored(const UiContext& ui) {
  const Scoring& scoring = ui.state.scoring;
  if (!ui.has_shape()) return ui.needs_shape();
  if (scoring.by_file) return scoring.of_file ? "" : "Choose the model first.";
  if (!ui.state.models.shapes.fitted.model) return "Open a study of this template (Tab), or choose a model's file.";
  return scoring.no_model;
}

std::string scored_by_in_words(const UiContext& ui) {
  const Scoring& scoring = ui.state.scoring;
  return scoring.by_file ? scoring.file.filename().string() : std::string();
}

void draw_score_section(const UiContext& ui, Outbox& out) {
  draw_scored_by(ui, out);
  if (const std::string refusal = why_not_scored(ui); !refusal.empty()) return explanation(ui.theme, refusal);
  const auto& scored = ui.work.scores.latest();
  const bool known =
      scored && scored->model == ui.state.scoring.model() && scored->structure == ui.state.look.structure;
  if (!known) {
    const std::string& error = ui.work.scores.error();
    return explanation(ui.theme, error.empty() ? "Scoring\xe2\x80\xa6" : error);
  }
  if (!scored->score) return explanation(ui.theme, scored->refusal);
  draw_score_figures(ui, *scored, out);
  draw_score_colours(ui, out);
}

}  // namespace homolog
