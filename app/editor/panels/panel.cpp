#include "app/editor/panels/ui_context.h"
#include "app/editor/widgets/widgets.h"

namespace homolog {

CaseNumber::CaseNumber(const UiContext& ui, std::string control, double committed)
    : value(committed), ui_(ui), control_(std::move(control)), committed_(committed) {
  const auto& edit = ui.state.panel_edit;
  if (edit && edit->control == control_) value = edit->value;
}

void CaseNumber::settle(bool changed, bool released, const std::function<Action(double)>& action_for,
                        Outbox& out) const {
  if (changed && !released) {
    if (ui_.state.playing) out.send(PlayFrames{false});
    out.send(ChangeNumber{PanelEdit{control_, value}});
    out.preview(action_for(value));
  }
  if (!released) return;
  out.send(ChangeNumber{});
  if (value != committed_)
    out.apply(action_for(value));
  else
    out.preview(std::nullopt);
}

void draw_sections(const UiContext& ui, const char* name, const RectPx& rect, std::span<const PanelSection> sections,
                   std::span<const bool> open, Command (*open_section)(std::size_t, bool), Outbox& out) {
  const Theme& theme = ui.theme;
  begin_region(name, rect, palette::surface);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {theme.px(12), 0});
  ImGui::BeginChild("sections", {0, 0}, false, ImGuiWindowFlags_AlwaysUseWindowPadding);
  for (std::size_t i = 0; i < sections.size(); ++i) {
    bool toggled = false;
    const bool shown = section(theme, sections[i].title, open[i], toggled);
    if (toggled) out.send(open_section(i, !open[i]));
    if (!shown) continue;
    {
      const Part part(sections[i].title);
      sections[i].draw(ui, out);
    }
    gap(theme, 8);
  }
  ImGui::EndChild();
  ImGui::PopStyleVar();
  end_region();
}

void draw_side_panel(const UiContext& ui, Outbox& out) {
  static constexpr std::array<PanelSection, 6> sections{{{"Case", draw_case_section},
                                                         {"Reference", draw_reference_section},
                                                         {"Place", draw_place_section},
                                                         {"Deform", draw_deform_section},
                                                         {"Correspondence", draw_correspondence_section},
                                                         {"Export", draw_export_section}}};
  const auto open_section = [](std::size_t section, bool open) -> Command { return OpenSection{section, open}; };
  draw_sections(ui, "side panel", ui.layout.panel, sections, ui.state.preferences.sections_open, open_section, out);
}

}  // namespace homolog
