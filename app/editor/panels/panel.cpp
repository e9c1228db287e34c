#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "app/editor/panels/ui_context.h"
#include "app/editor/widgets/imgui_context.h"
#include "app/editor/widgets/widgets.h"
#include "core/catalogue/catalogue.h"

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

namespace {

/// Keeps the section at the pointer where it is, or else the one at the panel's top, when something above it grows or
/// shrinks: the curve of a cine, or the rows of a template.
class LookedAt {
 public:
  LookedAt() {
    if (ImGui::IsWindowHovered(ImGuiHoveredFlags_AllowWhenBlockedByActiveItem))
      place_px_ += ImGui::GetMousePos().y - ImGui::GetWindowPos().y;
  }
  /// The panel goes to a place of its own.
  void lead(float top_px) {
    ImGui::SetScrollY(top_px);
    led_ = true;
  }
  /// A section begins at `top_px`. The last one that began above the place before counts.
  void meet(const char* title, float top_px) {
    float& before_px =
        *ImGui::GetStateStorage()->GetFloatRef(ImGui::GetID((std::string("top of ") + title).c_str()), top_px);
    if (before_px <= place_px_ + 1) grown_px_ = top_px - before_px;
    before_px = top_px;
  }
  void keep() const {
    if (!led_ && grown_px_ != 0) ImGui::SetScrollY(ImGui::GetScrollY() + grown_px_);
  }

 private:
  float place_px_ = ImGui::GetScrollY(), grown_px_ = 0;
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
    if (std::string_view(one.title) == place_section &&
        std::exchange(controls_memory().place_shown, ui.state.place_wanted) != ui.state.place_wanted)
      looked_at.lead(ImGui::GetCursorPosY());
    const float top_px = ImGui::GetCursorPosY();
    looked_at.meet(one.title, top_px);
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

// The sections of the side panel, each in the file panel_*.cpp of its name.
void draw_case_section(const UiContext& ui, Outbox& out);
void draw_cine_section(const UiContext& ui, Outbox& out);
void draw_template_section(const UiContext& ui, Outbox& out);
void draw_place_section(const UiContext& ui, Outbox& out);
void draw_deform_section(const UiContext& ui, Outbox& out);
void draw_correspondence_section(const UiContext& ui, Outbox& out);
void draw_export_section(const UiContext& ui, Outbox& out);
// What some of them say while they are folded.
std::string template_in_words(const UiContext& ui);
std::string placed_in_words(const UiContext& ui);

void draw_side_panel(const UiContext& ui, Outbox& out) {
  // In the order of the work.
  static constexpr auto is_cine = [](const UiContext& shown) {
    return shown.document().volume && shown.document().volume->frames > 1;
  };
  // Whoever opens a scan of their own needs a template of their organ first; the phantoms come with theirs.
  static constexpr auto is_own_scan = [](const UiContext& shown) {
    return shown.document().volume && !is_phantom(shown.document().volume_source);
  };
  static constexpr std::array<PanelSection, 7> sections{
      {{"Case", draw_case_section, true},
       {"Cine", draw_cine_section, true, is_cine},
       {"Template", draw_template_section, false, nullptr, is_own_scan, template_in_words},
       {place_section, draw_place_section, false, nullptr, nullptr, placed_in_words},
       {"Deform", draw_deform_section, true},
       {"Correspondence", draw_correspondence_section, true},
       {"Export", draw_export_section, false}}};
  draw_sections(ui, "side panel", ui.layout.panel, sections, out);
}

}  // namespace homolog
