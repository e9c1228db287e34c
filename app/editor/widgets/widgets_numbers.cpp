#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "app/editor/widgets/drawn_items.h"
#include "app/editor/widgets/imgui_context.h"
#include "app/editor/widgets/widgets.h"

// A number's typing (TempInputText) is declared here only.
#include <imgui_internal.h>

// Numbers that are dragged or typed.

namespace homolog {

namespace {

using Digits = std::array<char, 64>;

Digits digits_of(const char* pattern, double value) {
  Digits digits{};
  std::snprintf(digits.data(), digits.size(), pattern, value);
  return digits;
}

std::string without_blanks_around(const std::string& text) {
  const auto first = text.find_first_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

/// The number that a text is, with the unit behind it or without; nullopt where it is none.
std::optional<double> number_in(std::string text, const std::string& unit) {
  text = without_blanks_around(text);
  if (!unit.empty() && text.ends_with(unit)) text = without_blanks_around(text.substr(0, text.size() - unit.size()));
  const std::string minus = "\xe2\x88\x92";
  if (text.starts_with(minus)) text.replace(0, minus.size(), "-");
  const char* first = text.c_str();
  const char* const end = first + text.size();
  if (*first == '+') ++first;
  double value = 0;
  const auto read = std::from_chars(first, end, value);
  const bool whole_text = read.ec == std::errc() && read.ptr == end;
  return whole_text && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// Why what was typed cannot be taken; empty where it can.
std::string refusal_of(const std::string& text, std::optional<double> value, const NumberLimits& limits,
                       const std::string& unit) {
  const std::string what = limits.name + " stays as it is: \"" + text + "\" ";
  if (!value) {
    const bool comma = text.find(',') != std::string::npos;
    return what + (comma ? "has a comma. Type the number with a point, as 0.5." : "is no number.");
  }
  const bool inside = *value >= limits.low && *value <= limits.high;
  const std::string with_unit = unit.empty() ? "" : " " + unit;
  if (!inside)
    return what + format("is outside its limits. Type a number from %.6g to %.6g", limits.low, limits.high) +
           with_unit + ".";
  return limits.whole && *value != std::round(*value) ? what + "is not a whole number." : "";
}

/// The frame of a number that is being typed. The text is taken when the typing ends, not letter by letter: "8" may be
/// the beginning of "80".
void draw_typing(ImVec2 at, ImVec2 size, ImGuiID item) {
  const ImRect box(at, {at.x + size.x, at.y + size.y});
  ImGui::ItemSize(box, ImGui::GetStyle().FramePadding.y);
  if (!ImGui::ItemAdd(box, item, &box, ImGuiItemFlags_Inputable)) return;
  std::string& text = controls_memory().typed.text;
  std::array<char, 256> buffer{};
  text.copy(buffer.data(), buffer.size() - 1);
  ImGui::TempInputText(box, item, "##number", buffer.data(), static_cast<int>(buffer.size()),
                       ImGuiInputTextFlags_AutoSelectAll | static_cast<int>(ImGuiInputTextFlags_NoMarkEdited));
  text = buffer.data();
}

/// Takes what was typed into `value`, or says why not. True where it was taken.
bool take_typed(double& value, const char* unit, const NumberLimits& limits) {
  const TypedNumber typed = std::exchange(controls_memory().typed, {});
  const std::string text = without_blanks_around(typed.text);
  if (text.empty() || typed.text == typed.before) return false;
  const auto number = number_in(text, unit);
  if (std::string refusal = refusal_of(text, number, limits, unit); !refusal.empty()) {
    controls_memory().refusals.push_back(std::move(refusal));
    return false;
  }
  value = *number;
  return true;
}

}  // namespace

bool number_field(const Theme& theme, const char* id, double& value, bool& released, const NumberOptions& options) {
  const auto& [per_px, pattern, unit, width_px, tip, height_units, limits] = options;
  const EvenDigits of_one_width(theme);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float height = theme.px(height_units);
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {theme.px(6), (height - ImGui::GetFontSize()) / 2});
  ImGui::SetNextItemWidth(width_px);
  ImGui::PushID(id);
  const ImGuiID item = ImGui::GetID("##number");
  const bool typing = ImGui::TempInputIsActive(item);
  bool changed = false;
  released = false;
  if (typing) {
    draw_typing(at, {width_px, height}, item);
  } else {
    // ImGui centres the number of a drag field: hidden here and drawn again at the right edge.
    ImGui::PushStyleColor(ImGuiCol_Text, IM_COL32_BLACK_TRANS);
    changed = ImGui::DragScalar("##number", ImGuiDataType_Double, &value, static_cast<float>(per_px), nullptr, nullptr,
                                pattern);
    ImGui::PopStyleColor();
    if (changed) value = std::clamp(value, limits.low, limits.high);
    released = ImGui::IsItemDeactivatedAfterEdit();
    if (ImGui::TempInputIsActive(item)) {
      const std::string text = digits_of(pattern, value).data();
      controls_memory().typed = {item, text, text};
    }
  }
  ImGui::PopStyleVar();
  ImGui::PopID();
  if (controls_memory().typed.item == item && !ImGui::TempInputIsActive(item) && take_typed(value, unit, limits))
    changed = released = true;
  constexpr double px_per_step = 4;
  if (const int steps = key_focus().take_steps(); steps != 0) {
    value = std::clamp(value + steps * px_per_step * per_px, limits.low, limits.high);
    changed = released = true;
  }
  const std::string text = digits_of(pattern, value).data() + (unit[0] != 0 ? std::string(" ") + unit : std::string());
  note_control(DrawnItem::Kind::number, id, text, tip);
  if (!tip.empty() && !typing && is_explained()) tooltip(theme, tip);
  if (!ImGui::TempInputIsActive(item)) {
    const bool disabled = (ImGui::GetCurrentContext()->CurrentItemFlags & ImGuiItemFlags_Disabled) != 0;
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    text_at(*ImGui::GetWindowDrawList(),
            {std::floor(at.x + width_px - theme.px(6) - size.x), std::floor(at.y + (height - size.y) / 2)},
            disabled ? palette::faint : palette::text, text);
  }
  return changed;
}

}  // namespace homolog
