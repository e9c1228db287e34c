#include <array>
#include <cstdarg>
#include <cstdio>

#include "app/editor/widgets/drawn_items.h"
#include "app/editor/widgets/imgui_context.h"
#include "app/editor/widgets/widgets.h"

// Texts, and what fits into a width.

namespace homolog {

std::string format(const char* pattern, ...) {
  std::array<char, 512> text{};
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text.data(), text.size(), pattern, arguments);
  va_end(arguments);
  return text.data();
}

ImVec2 text_size(ImFont* font, const std::string& text) {
  return font->CalcTextSizeA(font->FontSize, 1e6f, 0, text.c_str());
}

std::string shortened(const std::string& text, float width_px) {
  const auto fits = [width_px](const std::string& t) { return ImGui::CalcTextSize(t.c_str()).x <= width_px; };
  if (text.empty() || fits(text)) return text;
  const std::string ellipsis = "\xe2\x80\xa6";
  std::vector<std::size_t> characters;  // where each begins in UTF-8
  for (std::size_t i = 0; i < text.size(); ++i)
    if ((static_cast<unsigned char>(text[i]) & 0xC0U) != 0x80U) characters.push_back(i);
  for (std::size_t kept = characters.size(); kept-- > 2;) {
    const std::size_t tail = kept / 2, head = kept - tail;
    const std::string shorter =
        text.substr(0, characters[head]) + ellipsis + text.substr(characters[characters.size() - tail]);
    if (fits(shorter)) return shorter;
  }
  return fits(ellipsis) ? ellipsis : std::string();
}

void text_at(ImDrawList& draw, ImFont* font, ImVec2 at, ImU32 colour, const std::string& text, float wrap_px) {
  draw.AddText(font, font->FontSize, at, colour, text.c_str(), nullptr, wrap_px);
  look_for_letters(text);
  if (!notes_items() || text.empty()) return;
  const ImVec2 size = font->CalcTextSizeA(font->FontSize, 1e6f, wrap_px, text.c_str());
  note_text(text, at, {at.x + size.x, at.y + size.y}, draw.GetClipRectMin(), draw.GetClipRectMax());
}

void text_at(ImDrawList& draw, ImVec2 at, ImU32 colour, const std::string& text) {
  text_at(draw, ImGui::GetFont(), at, colour, text);
}

void shadowed_text(ImDrawList& draw, ImFont* font, ImVec2 at, ImU32 colour, const std::string& text) {
  const ImU32 shadow = with_alpha(palette::mark_shadow, static_cast<float>(colour >> IM_COL32_A_SHIFT) / 255);
  for (const ImVec2 aside : {ImVec2{1, 1}, ImVec2{-1, 0}, ImVec2{0, -1}})
    draw.AddText(font, font->FontSize, {at.x + aside.x, at.y + aside.y}, shadow, text.c_str());
  text_at(draw, font, at, colour, text);
}

void text_line(const std::string& text, ImU32 colour) {
  look_for_letters(text);
  ImGui::PushStyleColor(ImGuiCol_Text, colour);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopStyleColor();
  const ImDrawList& draw = *ImGui::GetWindowDrawList();
  note_text(text, ImGui::GetItemRectMin(), ImGui::GetItemRectMax(), draw.GetClipRectMin(), draw.GetClipRectMax());
}

void text_lines(const std::string& text, ImU32 colour, float end_px) {
  ImGui::PushTextWrapPos(end_px);
  text_line(text, colour);
  ImGui::PopTextWrapPos();
}

}  // namespace homolog
