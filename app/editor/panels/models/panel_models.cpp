#include <algorithm>
#include <cmath>

#include "app/editor/panels/models/models_panel.h"
#include "app/editor/state/icons.h"
#include "app/editor/update/controls.h"
#include "app/editor/widgets/plots.h"
#include "app/editor/widgets/widgets.h"
#include "core/base/files/file_stem.h"

namespace homolog {

namespace {

void ask_for_file(Outbox& out, FilePurpose purpose, const std::string& name) {
  out.send(ShowFileDialog{purpose, name});
}

void draw_poses(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  const float width = std::floor((ImGui::GetContentRegionAvail().x - 2 * theme.px(4)) / 3);
  if (button(theme, "Mean", "Sets every mode to 0: the mean shape", {}, width)) out.send(ShowMean{});
  ImGui::SameLine(0, theme.px(4));
  if (button(theme, "Random",
             "A random shape of the model: b ~ N(0, \xce\xbb), every mode within \xc2\xb1"
             "3 standard deviations",
             {}, width))
    out.send(ShowSample{});
  ImGui::SameLine(0, theme.px(4));
  const bool in_model = state.made.model->index_of(state.list.selected) >= 0;
  if (button(theme, "Selected",
             "Shows the selected case in the model: its coefficients, limited to \xc2\xb1"
             "3 standard deviations",
             in_model ? "" : "Select a case that is in the model.", width))
    out.send(ShowSelectedShape{});
}

void draw_mode_sliders(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  const Eigen::VectorXd all = state.made.model->components->variances();
  const double total = all.sum();
  constexpr std::size_t first_few = 5;
  const std::size_t count = state.view.deviations.size();
  const std::size_t shown = state.view.all_modes || count <= first_few + 1 ? count : first_few;
  for (std::size_t k = 0; k < shown; ++k) {
    const double variance = state.made.model->model.variances[static_cast<Eigen::Index>(k)];
    const Part part(format("mode %zu", k + 1), "mode");
    const bool playing = state.view.animated_mode == k;
    if (icon_button(theme, playing ? icon::pause : icon::play, "animate",
                    playing ? "Stop"
                            : format("Move mode %zu between \xe2\x88\x92"
                                     "3 and +3 standard deviations",
                                     k + 1),
                    {}, playing, 24))
      out.send(AnimateMode{playing ? std::nullopt : std::optional(k)});
    ImGui::SameLine(0, theme.px(4));
    double value = state.view.deviations[k];
    bool released = false;
    const std::string label = format("%zu  %.1f %%", k + 1, 100 * variance / total);
    const std::string tip = format(
        "Mode %zu in standard deviations; one is \xe2\x88\x9a\xce\xbb = %.2f mm over all vertices. It holds %.1f %% "
        "of "
        "the variance.",
        k + 1, std::sqrt(variance), 100 * variance / total);
    if (slider(theme, label.c_str(), value, {-3, 3, "%+.2f", "\xcf\x83", false}, tip, released))
      out.send(SetMode{k, value});
  }
  if (count > first_few + 1 &&
      button(theme, state.view.all_modes ? format("First %zu modes", first_few) : format("All %zu modes", count),
             "Switches between the first five modes and all modes of the model", {}, ImGui::GetContentRegionAvail().x))
    out.send(ShowAllModes{!state.view.all_modes});
}

/// A button that goes on to the next group.
void draw_group_choice(const UiContext& ui, std::size_t which, const std::vector<std::string>& groups, float width_px,
                       Outbox& out) {
  const std::string& now = ui.state.models.view.compared[which];
  const Part part(which == 0 ? "from" : "to");
  if (button(ui.theme, shortened(now, width_px - ui.theme.px(16)),
             (which == 0 ? "First group. Click for the next one: " : "Second group. Click for the next one: ") + now,
             {}, width_px)) {
    const auto found = std::find(groups.begin(), groups.end(), now);
    const auto next = found == groups.end() ? 0 : (found - groups.begin() + 1) % std::ssize(groups);
    out.send(CompareGroup{which, groups[next]});
  }
}

void draw_difference(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  const auto groups = state.made.model->comparable_groups();
  bool shown = state.view.show_difference;
  if (toggle(
          theme, "Difference of two groups", shown,
          "Colours the mean shape by the distance between the means of two groups, along the normal. Red: the second "
          "group lies outside the first. Blue: inside",
          groups.size() < 2 ? "Give the cases groups first. Two groups with at least two cases each are needed." : ""))
    out.send(ShowDifference{shown});
  if (!state.view.show_difference || groups.size() < 2) return;
  const float half = std::floor((ImGui::GetContentRegionAvail().x - theme.px(8)) / 2);
  draw_group_choice(ui, 0, groups, half, out);
  ImGui::SameLine(0, theme.px(8));
  draw_group_choice(ui, 1, groups, half, out);
}

}  // namespace

void draw_model_section(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  int alignment = static_cast<int>(state.made.alignment);
  caption(theme, "Alignment of the shapes");
  if (choice(theme, "alignment", {"Similarity", "Rigid", "As they lie"}, alignment,
             {.tips = {"Generalised Procrustes: position, turn and size are taken out",
                       "Position and turn are taken out; size is part of the model", "Shapes stay where they are"}}))
    out.send(ChooseAlignment{static_cast<Alignment>(alignment)});
  if (!state.made.model) {
    explanation(theme, "Two shapes in correspondence make a model.");
    return;
  }
  const StudyModel& model = *state.made.model;
  const Eigen::VectorXd all = model.components->variances();
  figure(
      theme, "Modes",
      format("%td of %td hold %.1f %%", model.model.modes(), all.size(), 100 * model.model.variances.sum() / all.sum()),
      "The smallest number of modes that holds 95 % of the variance");
  draw_poses(ui, out);
  draw_mode_sliders(ui, out);
  draw_difference(ui, out);
  const float half = std::floor((ImGui::GetContentRegionAvail().x - theme.px(8)) / 2);
  if (button(theme, "Export model\xe2\x80\xa6", "statismo / scalismo 0.9: .h5.json or .h5" + of_optimised(state), {},
             half))
    ask_for_file(out, FilePurpose::export_model, study_stem(state) + ".h5.json");
  ImGui::SameLine(0, theme.px(8));
  if (button(theme, "Report\xe2\x80\xa6",
             "One page (.html) that a browser shows without a network: mean, modes, cases, doubt, methods. Of the "
             "shapes as they are in the study's files",
             ui.work.write_report ? "" : "This program has no reports.", half))
    ask_for_file(out, FilePurpose::export_report, study_stem(state) + ".html");
}

namespace {

/// The same measures as ShapeWorks defines them, at the same number of modes.
void draw_shapeworks_measures(const Theme& theme, const Evaluation& evaluation) {
  gap(theme, 4);
  caption(theme, "By ShapeWorks' definitions");
  struct Row {
    const char *name, *label, *tip;
  };
  static constexpr std::array<Row, 3> rows{
      {{"compactness", "Compactness",
        "Share of the variance that the modes hold. In brackets: one standard error below and above"},
       {"generalization", "Generalisation",
        "Each shape is left out and rebuilt by a model of the others, without clamping or a new alignment. Mean "
        "Euclidean distance of the particles"},
       {"specificity", "Specificity",
        "Mean Euclidean distance of the particles to the nearest training shape. ShapeWorks takes the singular values "
        "\xe2\x88\x9a((M\xe2\x88\x92"
        "1)\xce\xbb) as variances. So compare this number only with numbers from ShapeWorks"}}};
  for (const Row& row : rows) {
    const Measures* measures = evaluation.find_shapeworks(row.name);
    if (measures == nullptr) continue;
    const Measured& one = measures->front();
    const bool share = row.name == rows[0].name;
    figure(theme, row.label,
           share ? format("%.1f %% (%.0f to %.0f)", 100 * one.mean, 100 * std::max(one.mean - one.standard_error, 0.0),
                          100 * std::min(one.mean + one.standard_error, 1.0))
                 : format("%.3f \xc2\xb1 %.3f mm", one.mean, one.standard_error),
           row.tip);
  }
}

}  // namespace

void draw_measures_section(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  const float width = ImGui::GetContentRegionAvail().x;
  if (!state.made.evaluation || state.runs.evaluating) {
    const bool enough = state.made.model && state.made.model->names.size() >= 3;
    explanation(theme, "Compactness, generalisation and specificity at every number of modes.");
    if (button(theme, std::string(icon::chart) + "  Measure",
               "Measures the model. Specificity takes 1,000 random shapes (seed 1)",
               ButtonOptions{.refusal = state.runs.evaluating ? "The model is being measured."
                                        : !enough ? "At least three shapes are needed: one is left out each time."
                                        : state.made.optimisation.runs() ? "Wait until the shapes are optimised."
                                                                         : "",
                             .width_px = width,
                             .primary = true}))
      out.send(StartEvaluation{});
    std::optional<WorkShown> running;
    if (state.runs.evaluating) running = {"Measuring", state.runs.evaluating_fraction, "Stop measuring"};
    if (work_area(theme, "", running)) out.send(CancelEvaluation{});
    return;
  }
  const Evaluation& evaluation = *state.made.evaluation;
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  for (const Plot& plot : plots_of(evaluation)) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float height = theme.px(148);
    ImGui::Dummy({width, height});
    const bool pointed = ImGui::IsItemHovered();
    draw_plot(draw, theme, {at.x, at.y, width, height}, plot,
              pointed ? std::optional(ImGui::GetIO().MousePos) : std::nullopt);
  }
  const int modes = evaluation.modes.front();
  const auto mean_mm = [&](const char* name) {
    const Measures* measures = evaluation.find(name);
    if (measures == nullptr) return std::string("no faces");
    return format("%.3f \xc2\xb1 %.3f mm", measures->front().mean, measures->front().standard_error);
  };
  caption(theme, format("At %d %s, \xc2\xb1 standard error", modes, modes == 1 ? "mode" : "modes").c_str());
  figure(theme, "Generalisation, vertices", mean_mm("generalization"), "Mean Euclidean distance of the vertices, mm");
  figure(theme, "Generalisation, surface", mean_mm("generalization_surface"),
         "Symmetric mean surface distance, mm. If it is much smaller than the distance of the vertices, vertices "
         "slide along the surface");
  figure(theme, "Specificity, vertices", mean_mm("specificity"), "Mean Euclidean distance of the vertices, mm");
  draw_shapeworks_measures(theme, evaluation);
  const float half = std::floor((width - theme.px(8)) / 2);
  if (button(theme, "Table\xe2\x80\xa6", "All measures with their standard errors: .csv or .json" + of_optimised(state),
             {}, half))
    ask_for_file(out, FilePurpose::export_measures, study_stem(state) + "-measures.csv");
  ImGui::SameLine(0, theme.px(8));
  if (button(theme, "Plots\xe2\x80\xa6", "The three plots side by side: .png" + of_optimised(state), {}, half))
    ask_for_file(out, FilePurpose::export_plots, study_stem(state) + "-measures.png");
}

/// Pictures of what the Models mode shows.
void draw_study_pictures_section(const UiContext& ui, Outbox& out) {
  PictureOptions options = ui.state.saving.picture;
  int what = options.study ? static_cast<int>(*options.study) + 1 : 0;
  caption(ui.theme, "Picture of");
  bool changed =
      choice(ui.theme, "picture of", {"Window", "Gallery", "Modes"}, what,
             {.tips = {"The whole window, as it is on the screen", "All shapes, seen from where you look at them",
                       "The first modes of the model: \xe2\x88\x92"
                       "3\xe2\x88\x9a\xce\xbb, mean, +3\xe2\x88\x9a\xce\xbb"}});
  options.study = what == 0 ? std::nullopt : std::optional(static_cast<StudyPicture>(what - 1));
  if (options.study) changed |= draw_picture_options(ui.theme, options);
  if (changed) out.send(SetPicture{options});
  const std::string kind = what == 0 ? "" : what == 1 ? "-gallery" : "-modes";
  if (button(ui.theme, std::string(icon::camera) + "  Save the picture\xe2\x80\xa6", "PNG",
             options.study && !ui.state.models.made.model ? "Two shapes in correspondence make a model." : "",
             ImGui::GetContentRegionAvail().x))
    ask_for_file(out, FilePurpose::export_picture, study_stem(ui.state.models) + kind + ".png");
}

void draw_models_panel(const UiContext& ui, const RectPx& rect, Outbox& out) {
  static constexpr std::array<PanelSection, 7> sections{{{"Model", draw_model_section, true},
                                                         {"Measures", draw_measures_section, true},
                                                         {"Optimise", draw_optimise_section, false},
                                                         {"Sizes", draw_sizes_section, false},
                                                         {"Observers", draw_observers_section, false},
                                                         {"To check", draw_suspicion_section, true},
                                                         {"Pictures", draw_study_pictures_section, false}}};
  draw_sections(ui, "models panel", rect, sections, out);
}

std::string study_stem(const ModelsState& state) {
  const std::string name = file_stem(state.kept.file);
  return name.empty() ? "study" : name;
}

std::string of_optimised(const ModelsState& state) {
  return state.made.optimisation.shown ? ". Of the optimised shapes, as they are shown" : "";
}

}  // namespace homolog
