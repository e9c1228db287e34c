#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "app/editor/widgets/drawn_items.h"
#include "app/editor/widgets/imgui_context.h"
#include "app/editor/widgets/noted_box.h"
#include "app/editor/widgets/widgets.h"
#include "core/base/text/text.h"

// ImTextCharToUtf8 is declared here only.
#include <imgui_internal.h>

// Lists, menus and places that take clicks.

namespace homolog {

namespace {
using Kind = DrawnItem::Kind;
}

AreaState area(const Theme& theme, const std::string& name, ImVec2 size, const std::string& tip,
               const AreaOptions& options) {
  constexpr ImGuiButtonFlags all_buttons =
      ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight | ImGuiButtonFlags_MouseButtonMiddle;
  if (options.lies_below) ImGui::SetItemAllowOverlap();
  AreaState state;
  state.clicked = ImGui::InvisibleButton(name.c_str(), size, options.all_buttons ? all_buttons : 0);
  if (options.lies_below) ImGui::SetItemAllowOverlap();
  state.hovered = ImGui::IsItemHovered();
  state.doubled = state.hovered && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
  note_control(options.all_buttons ? Kind::area : Kind::row, name, options.selected ? "on" : "off", tip);
  if (!tip.empty() && is_explained()) tooltip(theme, tip);
  return state;
}

AreaState list_row(const Theme& theme, const std::string& text, bool selected, ImVec2 size, const std::string& tip,
                   float indent_px, const std::vector<std::string>& names) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImGui::PushID(text.c_str());
  // What is chosen is told from what is pointed at.
  const ImU32 chosen = with_alpha(palette::accent, 0.25f), pointed = with_alpha(palette::accent, 0.38f);
  ImGui::PushStyleColor(ImGuiCol_Header, chosen);
  if (selected) ImGui::PushStyleColor(ImGuiCol_HeaderHovered, pointed);
  AreaState state;
  state.clicked = ImGui::Selectable("##row", selected, 0, size);
  ImGui::PopStyleColor(selected ? 2 : 1);
  ImGui::PopID();
  state.hovered = ImGui::IsItemHovered();
  state.doubled = state.hovered && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
  note_control(Kind::row, text, selected ? "on" : "off", tip);
  const float height = size.y > 0 ? size.y : ImGui::GetTextLineHeight();
  const float room = (size.x > 0 ? size.x : ImGui::GetContentRegionAvail().x) - indent_px - theme.px(8);
  const std::string shown = shortened_among(text, names, room);
  const std::string said = shown == text ? tip : tip.empty() ? text : text + "\n" + tip;
  if (!said.empty() && is_explained()) tooltip(theme, said);
  text_at(*ImGui::GetWindowDrawList(), {at.x + indent_px + theme.px(4), at.y + (height - ImGui::GetFontSize()) / 2},
          palette::text, shown);
  return state;
}

namespace {

/// Room for a swatch before a text, as spaces.
std::string swatch_room(const Theme& theme) {
  const float space = std::max(1.0f, ImGui::CalcTextSize(" ").x);
  return std::string(static_cast<std::size_t>(std::ceil(theme.px(18) / space)), ' ');
}

void draw_swatch(const Theme& theme, ImDrawList& draw, ImVec2 low, float height, ImU32 colour) {
  const float side = theme.px(10);
  colour_swatch(draw, theme, {low.x, std::floor(low.y + (height - side) / 2)}, side, colour);
}

}  // namespace

namespace {

/// Takes what is typed while a list or a menu is open, and shows it above the entries.
void draw_searched(const Theme& theme) {
  std::string& searched = controls_memory().searched;
  ImGuiIO& io = ImGui::GetIO();
  if (!io.WantTextInput)
    for (const ImWchar letter : io.InputQueueCharacters) {
      std::array<char, 5> bytes{};
      ImTextCharToUtf8(bytes.data(), letter);
      searched += bytes.data();
      key_focus().start_again();
    }
  if (!searched.empty()) caption(theme, ("Search: " + searched).c_str());
}

/// Whether an entry of a list or a menu holds what was typed.
bool is_searched(const std::string& entry) {
  const std::string& searched = controls_memory().searched;
  return searched.empty() || lower_case(entry).find(lower_case(searched)) != std::string::npos;
}

}  // namespace

bool combo(const Theme& theme, const char* name, const std::vector<std::string>& options, int& chosen,
           const std::vector<ImU32>& swatches) {
  const bool known = chosen >= 0 && chosen < static_cast<int>(options.size());
  const std::string shown = known ? options[chosen] : std::string();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const ImVec2 clip_low = ImGui::GetWindowDrawList()->GetClipRectMin(),
               clip_high = ImGui::GetWindowDrawList()->GetClipRectMax();
  const float width = ImGui::GetContentRegionAvail().x;
  ImGui::SetNextItemWidth(width);
  ImGui::PushID(name);
  const float arrow = ImGui::GetFrameHeight(), side = ImGui::GetStyle().FramePadding.x;
  const bool coloured = swatches.size() == options.size() && !options.empty();
  const std::string room = coloured ? swatch_room(theme) : std::string();
  const float room_px = coloured ? ImGui::CalcTextSize(room.c_str()).x : 0;
  const std::string fitting = shortened_among(shown, options, width - arrow - 2 * side - room_px);
  look_for_letters(shown);
  ImDrawList& below = *ImGui::GetWindowDrawList();
  const ImGuiID id = ImGui::GetID("##list");
  key_focus().offer(id, {at.x, at.y, width, ImGui::GetFrameHeight()}, {});
  const bool open = ImGui::BeginCombo("##list", (room + fitting).c_str());
  if (coloured && known) draw_swatch(theme, below, {at.x + side, at.y}, ImGui::GetFrameHeight(), swatches[chosen]);
  if (!open && fitting != shown && is_explained()) tooltip(theme, shown);
  note_box({.kind = Kind::list,
            .label = name,
            .value = shown,
            .low = at,
            .high = {at.x + width, at.y + ImGui::GetFrameHeight()},
            .clip_low = clip_low,
            .clip_high = clip_high,
            .hovered = !open && ImGui::IsItemHovered(),
            .at_keys = key_focus().marks(id)});
  bool changed = false;
  if (open) {
    enter_part(name);
    draw_searched(theme);
    bool any = false;
    for (std::size_t i = 0; i < options.size(); ++i) {
      if (!is_searched(options[i])) continue;
      any = true;
      const bool now = static_cast<int>(i) == chosen;
      const std::string row = shortened_among(options[i], options, width - 2 * side - room_px);
      look_for_letters(options[i]);
      const ImVec2 row_at = ImGui::GetCursorScreenPos();
      if (ImGui::Selectable((room + row + "###" + std::to_string(i)).c_str(), now) && !now) {
        chosen = static_cast<int>(i);
        changed = true;
      }
      if (coloured) draw_swatch(theme, *ImGui::GetWindowDrawList(), row_at, ImGui::GetTextLineHeight(), swatches[i]);
      note_control(Kind::row, options[i], now ? "on" : "off", {});
      if (row != options[i] && is_explained()) tooltip(theme, options[i]);
    }
    if (!any && !options.empty()) caption(theme, "Nothing is called so.");
    leave_part();
    ImGui::EndCombo();
  }
  ImGui::PopID();
  return changed;
}

void open_menu(const char* name) {
  // The press of this very click has closed it.
  if (std::exchange(controls_memory().menu_closed, 0U) != ImGui::GetID(name)) ImGui::OpenPopup(name);
}

bool begin_menu(const Theme& theme, const char* name) {
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {theme.px(8), theme.px(8)});
  const bool open = ImGui::BeginPopup(name);
  ImGui::PopStyleVar();
  if (!open) return false;
  enter_part(name);
  draw_searched(theme);
  return true;
}

bool menu_item(const Theme& theme, const char* label, const char* keys, const std::string& tip) {
  if (!is_searched(label)) return false;
  const bool chosen = ImGui::MenuItem(label, keys);
  note_control(Kind::row, label, {}, tip);
  if (!tip.empty() && is_explained()) tooltip(theme, tip);
  return chosen;
}

void menu_line() {
  ImGui::Separator();
}

void end_menu(const Theme&) {
  leave_part();
  ImGui::EndPopup();
}

}  // namespace homolog
