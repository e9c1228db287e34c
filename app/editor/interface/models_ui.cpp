#include "app/editor/interface/interface.h"
#include "app/editor/panels/models/models_panel.h"

#include <cmath>
#include <optional>
#include <utility>

#include "app/editor/state/icons.h"
#include "app/editor/update/controls.h"
#include "app/editor/update/window_title.h"
#include "app/editor/widgets/widgets.h"

namespace homolog {

namespace {

void draw_models_top_bar(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const RectPx& bar = ui.layout.top_bar;
  begin_region("top bar", bar, palette::surface, theme.px(8));
  draw_mode_switch(ui, out);
  ImGui::PushFont(theme.strong);
  const float switch_end = theme.px(8 + 140 + 16);
  const std::string title = shortened(study_title(ui.state.models), bar.width - 2 * switch_end);
  const ImVec2 size = ImGui::CalcTextSize(title.c_str());
  const ImVec2 at{std::floor((bar.width - size.x) / 2), std::floor((bar.height - size.y) / 2)};
  text_at(*ImGui::GetWindowDrawList(), at, palette::text, title);
  ImGui::PopFont();
  const std::string path = ui.state.models.kept.file.string();
  if (!path.empty() && size.x > 0) {
    ImGui::SetCursorScreenPos(at);
    area(theme, "study", size, path);
  }
  ImGui::SetCursorPos({bar.width - theme.px(36), theme.px(8)});
  if (icon_button(theme, icon::keys, "keys", "Keys and mouse (F1)", {}, false, 28)) out.send(ShowKeys{});
  end_region();
}

void draw_models_status(const UiContext& ui) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  const RectPx& bar = ui.layout.status_line;
  const float y = begin_status_line(ui);
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  std::string left = waiting_cases(state) > 0 ? "Cases wait: Fit waiting fits them to their label maps, or open one."
                                              : "Add meshes of one template, or open a study.";
  if (state.runs.modelling)
    left = format("Making the model: %.0f %%", 100 * state.runs.modelling_fraction);
  else if (!state.made.error.empty())
    left = state.made.error;
  else if (state.made.model)
    left = std::string("Drag: turn all shapes. Right-drag: move. ") +
           (gallery_pages(state) == 1 ? "Wheel: zoom." : "Wheel: pages. Ctrl+wheel: zoom.") +
           " Click: mark a vertex. Double-click: look at it.";
  const float from = bar.x + theme.px(12), room = bar.width - theme.px(120);
  const std::string fitting = whole_sentences(left, room);
  if (fitting != left && left == state.made.error) {
    draw_tall_message(ui, left);
  } else {
    text_at(draw, {from, y}, palette::dim, fitting);
    if (fitting != left) {
      ImGui::SetCursorScreenPos({from, y});
      area(theme, "message", {room, ImGui::GetFontSize()}, left);
    }
  }
  std::optional<EvenDigits> digits(std::in_place, theme);  // gone before the line ends
  const bool moves = state.gallery.turning && ui.frames_per_second >= 1;
  const std::string right = moves ? format("%.0f frames/s", ui.frames_per_second) : "";
  text_at(draw, {bar.x + bar.width - theme.px(12) - ImGui::CalcTextSize(right.c_str()).x, y}, palette::dim, right);
  digits.reset();
  end_status_line();
}

}  // namespace

void draw_mode_switch(const UiContext& ui, Outbox& out) {
  ImGui::BeginChild("mode", {ui.theme.px(140), ui.theme.px(28)});
  int mode = ui.state.models.shown ? 1 : 0;
  if (choice(ui.theme, "mode", {"Case", "Models"}, mode,
             {.tips = {"One image with its mesh (Tab)", "The study's shapes, their model and its measures (Tab)"}}))
    out.send(ShowModels{mode == 1});
  ImGui::EndChild();
}

void draw_models_interface(const UiContext& ui, Outbox& out) {
  const ModelsLayout layout = models_layout(ui.layout);
  draw_models_top_bar(ui, out);
  draw_case_table(ui, layout.cases, out);
  draw_gallery(ui, layout, out);
  draw_model_view(ui, layout, out);
  draw_models_panel(ui, layout.panel, out);
  draw_models_status(ui);
  draw_notices(ui, out);
  draw_dialogs(ui, out);
}

}  // namespace homolog
