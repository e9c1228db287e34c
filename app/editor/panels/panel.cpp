#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "app/editor/panels/sections.h"
#include "app/editor/panels/ui_context.h"
#include "app/editor/widgets/imgui_context.h"
#include "app/editor/widgets/widgets.h"
#include "core/catalogue/catalogue.h"

namespace homolog {

CaseNumber::CaseNumber(const UiContext& ui, std::string control, double committed)
    : value(committed), ui_(ui), control_(std::move(control)), committed_(committed) {
  const auto& edit = ui.state.hand.panel_edit;
  if (edit && edit->control == control_) value = edit->value;
}

void CaseNumber::settle(bool changed, bool released, const std::function<Action(double)>& action_for,
                        Outbox& out) const {
  if (changed && !released) {
    if (ui_.state.look.playing) out.send(PlayFrames{false});
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

namespace {

/// Keeps the control at the pointer where it is, or else the first one in the panel, when something above it grows or
/// shrinks: the curve of a cine, the stages of a template that is made, the rows of a template.
class LookedAt {
 public:
  /// The panel goes to a place of its own.
  void lead(float top_px) {
    ImGui::SetScrollY(top_px);
    led_ = true;
  }
  void keep() const {
    float& scrolled_before = *ImGui::GetStateStorage()->GetFloatRef(ImGui::GetID("scrolled"), ImGui::GetScrollY());
    const float since_px = ImGui::GetScrollY() - std::exchange(scrolled_before, ImGui::GetScrollY());
    if (led_) return;
    const bool pointed = ImGui::IsWindowHovered(ImGuiHoveredFlags_AllowWhenBlockedByActiveItem);
    const float at_px = pointed ? ImGui::GetMousePos().y : ImGui::GetWindowPos().y;
    if (const float grown_px = key_focus().moved_px(at_px) + since_px; std::abs(grown_px) >= 1)
      ImGui::SetScrollY(ImGui::GetScrollY() + grown_px);
  }

 private:
  bool led_ = false;
};

/// The section that was just opened is seen, all of it where there is room. `top_px` is where it begins in the panel.
void show_opened(float top_px) {
  const float bottom_px = ImGui::GetCursorPosY(), room = ImGui::GetWindowHeight();
  if (bottom_px > ImGui::GetScrollY() + room) ImGui::SetScrollY(std::min(top_px, bottom_px - room));
}

}  // namespace

void draw_sections(const UiContext& ui, const char* name, const RectPx& rect, std::span<const PanelSection> sections,
                   Outbox& out) {
  const Theme& theme = ui.theme;
  begin_region(name, rect, palette::surface);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {theme.px(12), 0});
  ImGui::BeginChild("sections", {0, 0}, false, ImGuiWindowFlags_AlwaysUseWindowPadding);
  ImGui::PopStyleVar();  // not of the lists that open from it
  const auto& sections_open = ui.state.preferences.sections_open;
  LookedAt looked_at;
  for (const PanelSection& one : sections) {
    if (one.wanted != nullptr && !one.wanted(ui)) continue;
    const auto chosen = sections_open.find(one.title);
    const bool at_first = one.opens != nullptr ? one.opens(ui) : one.open_at_first;
    const bool open = chosen == sections_open.end() ? at_first : chosen->second;
    bool toggled = false;
    if (one.title == ui.state.wanted_section &&
        std::exchange(controls_memory().section_shown, ui.state.section_wanted) != ui.state.section_wanted)
      looked_at.lead(ImGui::GetCursorPosY());
    const float top_px = ImGui::GetCursorPosY();
    const bool shown = section(theme, one.title, open, toggled, one.holds != nullptr ? one.holds(ui) : "");
    bool& opens = *ImGui::GetStateStorage()->GetBoolRef(ImGui::GetID(one.title));  // since the click that opens it
    if (toggled) {
      out.send(OpenSection{one.title, !open});
      opens = !open;
    }
    if (!shown) continue;
    {
      const Part part(one.title);
      one.draw(ui, out);
    }
    gap(theme, 8);
    if (std::exchange(opens, false)) show_opened(top_px);
  }
  looked_at.keep();
  ImGui::EndChild();
  end_region();
}

void draw_side_panel(const UiContext& ui, Outbox& out) {
  // In the order of the work.
  static constexpr auto is_cine = [](const UiContext& shown) {
    return shown.document().scan.image && shown.document().scan.image->frames > 1;
  };
  // Whoever opens a scan of their own needs a template of their organ first; the phantoms come with theirs.
  static constexpr auto is_own_scan = [](const UiContext& shown) {
    return shown.document().scan.image && !is_phantom(shown.document().scan.source);
  };
  // With several structures their list is what one works with.
  static constexpr auto has_several = [](const UiContext& shown) { return shown.document().structures.size() > 1; };
  static constexpr auto opens_structures = [](const UiContext& shown) {
    return has_several(shown) || shown.work.set_fitter.busy() ||
           (shown.structure() == nullptr && shown.labels().label_count() > 1);
  };
  // Beside a mesh that one works on, a map of several labels may come and go: nothing above may move for it.
  static constexpr auto may_have_structures = [](const UiContext& shown) {
    return !opens_structures(shown) && shown.labels().label_count() > 1;
  };
  static constexpr auto has_contours = [](const UiContext& shown) {
    return shown.state.automatic.offered.read != nullptr ||
           (shown.structure() != nullptr && !shown.structure()->contours.empty());
  };
  static constexpr auto has_one = [](const UiContext& shown) { return !has_several(shown); };
  static constexpr std::array<PanelSection, 12> sections{
      {{"Case", draw_case_section, true, nullptr, has_one},
       {structures_section, draw_structures_section, true, opens_structures, opens_structures, structures_in_words},
       {"Cine", draw_cine_section, true, is_cine},
       {"Template", draw_template_section, false, nullptr, is_own_scan, template_in_words},
       {place_section, draw_place_section, false, nullptr, nullptr, placed_in_words},
       {contours_section, draw_contours_section, false, nullptr, has_contours, contours_in_words},
       {deform_section, draw_deform_section, true},
       {"Correspondence", draw_correspondence_section, true},
       {measurements_section, draw_measurements_section, false, nullptr, nullptr, recipe_in_words},
       {score_section, draw_score_section, false, nullptr, nullptr, scored_by_in_words},
       {"Export", draw_export_section, false},
       {structures_section, draw_structures_section, false, may_have_structures}}};
  draw_sections(ui, "side panel", ui.layout.panel, sections, out);
}

}  // namespace homolog
