#include <algorithm>
#include <cmath>
#include <optional>

#include "app/editor/widgets/room.h"
#include "app/editor/widgets/widgets.h"

// Figures, explanations, bars and rules: what is only looked at, and a figure that leads somewhere.

namespace homolog {

float available() {
  return ImGui::GetContentRegionAvail().x;
}

void text_in(ImVec2 low, ImVec2 high, ImU32 colour, const std::string& text, float align) {
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  text_at(*ImGui::GetWindowDrawList(),
          {std::floor(low.x + (high.x - low.x - size.x) * align), std::floor(low.y + (high.y - low.y - size.y) / 2)},
          colour, text);
}

void progress_bar(const Theme& theme, double fraction) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, height = theme.px(4);
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  draw.AddRectFilled(at, {at.x + width, at.y + height}, palette::pressed, height / 2);
  draw.AddRectFilled(at, {at.x + width * static_cast<float>(fraction), at.y + height}, palette::accent, height / 2);
  ImGui::Dummy({width, height});
}

void two_lines(const Theme& theme, const std::string& text, ImU32 colour) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = available();
  constexpr float lines = 2, of_broken_lines = 0.85f;
  ImGui::BeginGroup();
  ImGui::PushFont(theme.small);
  const std::string shown = shortened(text, lines * of_broken_lines * width);
  if (!text.empty()) text_lines(shown, colour);
  ImGui::PopFont();
  ImGui::EndGroup();
  if (shown != text && is_explained()) tooltip(theme, text);
  ImGui::SetCursorScreenPos(at);
  ImGui::Dummy({width, theme.px(36)});
}

namespace {

/// Whether a text is of numbers and units: a name has letters at its digits, and is written as names are.
bool is_of_numbers(const std::string& text) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  bool any = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (!is_digit(text[i])) continue;
    any = true;
    const std::size_t next = i + 1 < text.size() && text[i + 1] == '.' ? i + 2 : i + 1;
    if ((i > 0 && is_letter(text[i - 1])) || (next < text.size() && is_letter(text[next]))) return false;
  }
  return any;
}

}  // namespace

void figure(const Theme& theme, const char* label, const std::string& value, const std::string& tip, ImU32 colour) {
  std::optional<EvenDigits> digits;
  if (is_of_numbers(value)) digits.emplace(theme);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = available(), row = theme.px(20);
  // Where the label leaves too little room the value has a row of its own.
  const float beside = width - ImGui::CalcTextSize(label).x - theme.px(8);
  const float wanted = ImGui::CalcTextSize(value.c_str()).x;
  const bool below = wanted > beside && beside < 0.5f * width;
  const std::string shown = shortened(value, below ? width : beside);
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, theme.px(2)});
  ImGui::Dummy({width, below ? 2 * row : row});
  ImGui::PopStyleVar();
  const std::string text = shown == value ? tip : tip.empty() || tip == value ? value : value + "\n" + tip;
  if (!text.empty() && is_explained()) tooltip(theme, text);
  text_in(at, {at.x + width, at.y + row}, palette::dim, shortened(label, width), 0);
  const float top = below ? at.y + row : at.y;
  text_in({at.x, top}, {at.x + width, top + row}, colour, shown, 1);
}

bool figure_link(const Theme& theme, const char* label, const std::string& value, const std::string& tip,
                 ImU32 colour) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const ImVec2 size{available(), theme.px(20)};
  const ImVec2 end{at.x + size.x, at.y + size.y};
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, theme.px(2)});
  const AreaState link = area(theme, label, size, tip);
  ImGui::PopStyleVar();
  if (link.hovered) ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
  text_in(at, end, link.hovered ? palette::text : palette::dim, label, 0);
  const std::string shown = shortened(value, size.x - ImGui::CalcTextSize(label).x - theme.px(8));
  text_in(at, end, colour, shown, 1);
  const float y = std::floor(end.y - theme.px(2));
  ImGui::GetWindowDrawList()->AddLine({end.x - ImGui::CalcTextSize(shown.c_str()).x, y}, {end.x, y}, colour);
  return link.clicked;
}

void explanation(const Theme& theme, const std::string& text) {
  ImGui::PushFont(theme.small);
  text_lines(text, palette::dim);
  ImGui::PopFont();
}

void caption(const Theme& theme, const char* text) {
  ImGui::PushFont(theme.small);
  text_line(text, palette::dim);
  ImGui::PopFont();
}

void colour_swatch(ImDrawList& draw, const Theme& theme, ImVec2 low, float side_px, ImU32 colour) {
  const ImVec2 high{low.x + side_px, low.y + side_px};
  draw.AddRectFilled(low, high, colour, theme.px(2));
  draw.AddRect(low, high, palette::faint, theme.px(2), 0, std::max(theme.scale, 1.0f));
}

void rule(const Theme& theme) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImGui::GetWindowDrawList()->AddLine(at, {at.x + available(), at.y}, palette::line);
  ImGui::Dummy({0, theme.px(1)});
}

void gap(const Theme& theme, float units) {
  ImGui::Dummy({0, theme.px(units)});
}

}  // namespace homolog
