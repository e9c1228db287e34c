#include <algorithm>
#include <array>
#include <cmath>

#include "app/editor/panels/ui_context.h"
#include "app/editor/update/results/set_fit.h"
#include "app/editor/widgets/widgets.h"
#include "core/catalogue/catalogue.h"

// The fit of a template set to the label map, in the section Structures.

namespace homolog {

namespace {

struct StepWords {
  const char* words;
  ImU32 colour;
};
StepWords words_of(SetFitStep step) {
  switch (step) {
    case SetFitStep::waits:
      return {"waits", palette::faint};
    case SetFitStep::runs:
      return {"is fitted\xe2\x80\xa6", palette::accent};
    case SetFitStep::fitted:
      return {"done", palette::good};
    case SetFitStep::runs_again:
      return {"once more\xe2\x80\xa6", palette::accent};
    case SetFitStep::failed:
      return {"failed", palette::amber};
  }
  return {"", palette::dim};
}

/// A row for each structure that is being fitted, with how far it is.
void draw_set_progress(const UiContext& ui) {
  const Theme& theme = ui.theme;
  const auto structures = ui.work.set_fitter.structures();
  constexpr float row_height = 20, most = 9;
  const float rows = std::clamp(static_cast<float>(structures.size()), 1.0f, most);
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, 0});
  ImGui::BeginChild("set fit", {0, std::floor(rows * theme.px(row_height))});
  if (structures.empty()) text_line("The label map is read\xe2\x80\xa6", palette::dim);
  const float width = ImGui::GetContentRegionAvail().x;
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  for (const StructureFitShown& one : structures) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const auto [words, colour] = words_of(one.step);
    const float words_width = ImGui::CalcTextSize(words).x;
    text_at(draw, {at.x + theme.px(4), at.y}, palette::text, shortened(one.name, width - words_width - theme.px(16)));
    text_at(draw, {at.x + width - words_width - theme.px(4), at.y}, colour, words);
    ImGui::Dummy({width, theme.px(row_height)});
  }
  ImGui::EndChild();
  ImGui::PopStyleVar();
}

void draw_set_choice(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const auto& automatic = ui.state.automatic;
  const float half = (ImGui::GetContentRegionAvail().x - theme.px(4)) / 2;
  const std::string busy = ui.work.set_fitter.busy() ? "The set is being fitted." : "";
  if (button(theme, "Spine", "The built-in set: T12 to the sacrum, with the discs between them",
             automatic.set_source == built_in_set_source() ? "This set is chosen." : busy, half))
    out.send(ChooseSet{built_in_set_source()});
  ImGui::SameLine(0, theme.px(4));
  if (button(theme, "Choose a set\xe2\x80\xa6", "A template set: NAME.set.json, as homolog set make writes it", busy,
             half))
    out.send(ShowFileDialog{FilePurpose::open_set, {}});
  const bool known = automatic.set != nullptr;
  figure(theme, "Template set",
         !known                              ? "none"
         : is_built_in(automatic.set_source) ? automatic.set_source
                                             : std::filesystem::path(automatic.set_source).filename().string(),
         known ? automatic.set_source : "");
  std::string there = "\xe2\x80\x93", tip = "How many of the set's structures are labels of the map";
  if (known && ui.labels().volume) {
    const auto names = names_in_map(automatic.set->set, ui.labels());
    there = format("%zu of %zu", names.size(), automatic.set->set.structures.size());
    for (std::size_t k = 0; k < names.size(); ++k) tip += (k == 0 ? ": " : ", ") + names[k];
  }
  figure(theme, "In the label map", there, tip);
}

}  // namespace

void draw_set_fit(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  caption(theme, "Fit a template set to the label map");
  draw_set_choice(ui, out);
  const std::string refusal = set_fit_refusal(ui.state, ui.on_screen, ui.work);
  const float half = (ImGui::GetContentRegionAvail().x - theme.px(4)) / 2;
  if (button(theme, "Fit the set",
             "Fits each template of the set to its label. The structures come into the case as one step to undo",
             ButtonOptions{.refusal = refusal, .width_px = half, .primary = ui.document().structures.size() < 2}))
    out.send(FitSet{});
  ImGui::SameLine(0, theme.px(4));
  if (button(
          theme, "Repair and fit",
          "Finds what is wrong with the labels first (missing, halves, levels, bridges\xe2\x80\xa6) and fits to what "
          "it proposes. What was found stands on top of the list. The label map stays as it is. One step to undo",
          refusal, half))
    out.send(FitSet{true});
  if (!ui.work.set_fitter.busy()) return;
  if (work_area(
          theme, "",
          WorkShown{ui.work.set_fitter.pass(), ui.work.set_fitter.fraction(), "The case stays as it is (Escape)"}))
    out.send(CancelSetFit{});
  draw_set_progress(ui);
}

}  // namespace homolog
