#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <optional>
#include <string_view>

#include "app/editor/widgets/drawn_items.h"
#include "app/editor/widgets/imgui_context.h"
#include "app/editor/widgets/widgets.h"

// Texts, and what fits into a width.

namespace homolog {

namespace {
constexpr const char* left_out = "\xe2\x80\xa6";
}

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
  std::vector<std::size_t> characters;  // where each begins in UTF-8
  for (std::size_t i = 0; i < text.size(); ++i)
    if ((static_cast<unsigned char>(text[i]) & 0xC0U) != 0x80U) characters.push_back(i);
  for (std::size_t kept = characters.size(); kept-- > 2;) {
    const std::size_t tail = kept / 2, head = kept - tail;
    const std::string shorter =
        text.substr(0, characters[head]) + left_out + text.substr(characters[characters.size() - tail]);
    if (fits(shorter)) return shorter;
  }
  return fits(left_out) ? left_out : std::string();
}

namespace {

bool begins_letter(const std::string& text, std::size_t at) {
  return at >= text.size() || (static_cast<unsigned char>(text[at]) & 0xC0U) != 0x80U;
}

/// Bytes that several names have in common at their beginnings and ends, at whole letters.
struct Shared {
  std::size_t head = std::string::npos, tail = std::string::npos;

  void with(const std::string& a, const std::string& b) {
    const std::size_t most = std::min(a.size(), b.size());
    const auto same_head = static_cast<std::size_t>(
        std::mismatch(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(most), b.begin()).first - a.begin());
    head = std::min(head, same_head);
    std::size_t same_tail = 0;
    while (same_tail < most - same_head && a[a.size() - 1 - same_tail] == b[b.size() - 1 - same_tail]) ++same_tail;
    tail = std::min(tail, same_tail);
    while (head > 0 && !begins_letter(a, head)) --head;
    while (tail > 0 && !begins_letter(a, a.size() - tail)) --tail;
  }
};

/// What names that would look much as `shortened`, which is this one's, share with it; nothing where it stands alone.
/// Those that have half of its ends count, so that a list is shortened in one way.
std::optional<Shared> shared_ends(const std::string& name, const std::vector<std::string>& names,
                                  const std::string& shortened) {
  const std::size_t gap = shortened.find(left_out);
  if (gap == std::string::npos) return std::nullopt;
  const std::size_t head = gap / 2, tail = (shortened.size() - gap - std::string_view(left_out).size()) / 2;
  const std::string_view end = std::string_view(name).substr(name.size() - tail);
  std::optional<Shared> shared;
  for (const std::string& other : names) {
    if (other == name || other.compare(0, head, name, 0, head) != 0 || !other.ends_with(end)) continue;
    if (!shared) shared.emplace();
    shared->with(name, other);
  }
  return shared;
}

}  // namespace

std::string shortened_among(const std::string& name, const std::vector<std::string>& names, float width_px) {
  const std::string alone = shortened(name, width_px);
  if (alone == name) return name;
  const auto shared = shared_ends(name, names, alone);
  if (!shared) return alone;
  const auto fits = [width_px](const std::string& t) { return ImGui::CalcTextSize(t.c_str()).x <= width_px; };
  const std::string own = name.substr(shared->head, name.size() - shared->tail - shared->head);
  const std::string after = shared->tail > 0 ? left_out : "";
  std::string best;
  // With the whole beginning, and of the end what there is room for.
  for (std::size_t kept = 0; kept < shared->tail; ++kept) {
    if (!begins_letter(name, name.size() - kept)) continue;
    const std::string text = name.substr(0, name.size() - shared->tail) + left_out + name.substr(name.size() - kept);
    if (!fits(text)) break;
    best = text;
  }
  if (!best.empty()) return best;
  // Else with as much of the beginning as there is room for.
  for (std::size_t kept = 0; kept <= shared->head; ++kept) {
    if (!begins_letter(name, kept)) continue;
    const std::string text = name.substr(0, kept) + (kept < shared->head ? left_out : "") + own + after;
    if (!fits(text)) break;
    best = text;
  }
  if (!best.empty()) return best;
  const bool alike = std::any_of(names.begin(), names.end(), [&](const std::string& other) {
    return other != name && shortened(other, width_px) == alone;
  });
  return alike ? shortened(own, width_px) : alone;
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
