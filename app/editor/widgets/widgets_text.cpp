#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <string_view>

#include "app/editor/widgets/drawn_items.h"
#include "app/editor/widgets/imgui_context.h"
#include "app/editor/widgets/widgets.h"
#include "core/base/text/short_names.h"

// Texts, and what fits into a width.

namespace homolog {

std::string format(const char* pattern, ...) {
  va_list arguments, measured;
  va_start(arguments, pattern);
  va_copy(measured, arguments);
  const int length = std::vsnprintf(nullptr, 0, pattern, measured);
  va_end(measured);
  std::string text(static_cast<std::size_t>(std::max(0, length)), '\0');
  std::vsnprintf(text.data(), text.size() + 1, pattern, arguments);
  va_end(arguments);
  return text;
}

ImVec2 text_size(ImFont* font, const std::string& text) {
  return font->CalcTextSizeA(font->FontSize, 1e6f, 0, text.c_str());
}

namespace {

/// Whether a text fits, in the font that is in use.
TextFits fits_into(float width_px) {
  return [width_px](const std::string& text) { return ImGui::CalcTextSize(text.c_str()).x <= width_px; };
}

}  // namespace

std::string shortened(const std::string& text, float width_px) {
  return shortened(text, fits_into(width_px));
}

std::string whole_sentences(const std::string& text, float width_px) {
  const TextFits fits = fits_into(width_px);
  if (fits(text)) return text;
  std::string best;
  for (std::size_t at = text.find(". "); at != std::string::npos; at = text.find(". ", at + 1)) {
    if (!fits(text.substr(0, at + 1))) break;
    best = text.substr(0, at + 1);
  }
  return best.empty() ? shortened(text, width_px) : best;
}

std::string shortened_among(const std::string& name, const std::vector<std::string>& names, float width_px) {
  return shortened_among(name, names, fits_into(width_px));
}

namespace {

/// Puts words into lines, one after the other.
class Lines {
 public:
  Lines(ImFont* font, float width_px) : font_(font), width_px_(width_px), blank_px_(width_of(" ")) {}

  void add(std::string_view word) {
    float word_px = width_of(word);
    const float before_px = begun_ ? line_px_ + blank_px_ : 0;
    if (before_px + word_px <= width_px_) return append(word, word_px);
    if (word_px > width_px_ && begun_) {
      // A long path begins beside what names it.
      const std::size_t part = path_part(word, width_px_ - before_px);
      append(word.substr(0, part), width_of(word.substr(0, part)));
      word.remove_prefix(part);
    }
    while ((word_px = width_of(word)) > width_px_) {
      end_line();
      std::size_t part = path_part(word, width_px_);
      if (part == 0) part = letters_part(word);
      append(word.substr(0, part), width_of(word.substr(0, part)));
      word.remove_prefix(part);
    }
    if (word.empty()) return;
    end_line();
    append(word, word_px);
  }
  void end_paragraph() {
    lines_ += '\n';
    begun_ = false;
    line_px_ = 0;
  }
  std::string take() { return std::move(lines_); }

 private:
  float width_of(std::string_view text) const {
    return font_->CalcTextSizeA(font_->FontSize, 1e6f, 0, text.data(), text.data() + text.size()).x;
  }
  void append(std::string_view word, float word_px) {
    if (word.empty()) return;
    if (begun_) lines_ += ' ';
    line_px_ += (begun_ ? blank_px_ : 0) + word_px;
    lines_ += word;
    begun_ = true;
  }
  void end_line() {
    if (begun_) end_paragraph();
  }
  /// Bytes up to the last "/" that fits; 0 where there is none.
  std::size_t path_part(std::string_view word, float room_px) const {
    for (std::size_t at = word.rfind('/'); at != std::string_view::npos && at > 0; at = word.rfind('/', at - 1))
      if (at + 1 < word.size() && width_of(word.substr(0, at + 1)) <= room_px) return at + 1;
    return 0;
  }
  /// Bytes of as many letters as fit, of one at least.
  std::size_t letters_part(std::string_view word) const {
    std::size_t part = 0;
    for (std::size_t next = 1; next <= word.size(); ++next) {
      if (next < word.size() && (static_cast<unsigned char>(word[next]) & 0xC0U) == 0x80U) continue;
      if (part > 0 && width_of(word.substr(0, next)) > width_px_) break;
      part = next;
    }
    return part;
  }

  ImFont* font_;
  float width_px_, blank_px_, line_px_ = 0;
  bool begun_ = false;  ///< the line holds a word
  std::string lines_;
};

}  // namespace

std::string in_lines(ImFont* font, const std::string& text, float width_px) {
  Lines lines(font, width_px);
  std::size_t from = 0;
  for (std::size_t at = 0; at <= text.size(); ++at) {
    if (at < text.size() && text[at] != ' ' && text[at] != '\n') continue;
    if (at > from) lines.add(std::string_view(text).substr(from, at - from));
    if (at < text.size() && text[at] == '\n') lines.end_paragraph();
    from = at + 1;
  }
  return lines.take();
}

void text_at(ImDrawList& draw, ImFont* font, ImVec2 at, ImU32 colour, const std::string& text, float wrap_px) {
  const std::string lines = wrap_px > 0 ? in_lines(font, text, wrap_px) : text;
  draw.AddText(font, font->FontSize, at, colour, lines.c_str());
  look_for_letters(text);
  if (!notes_items() || text.empty()) return;
  const ImVec2 size = text_size(font, lines);
  note_text(text, at, {at.x + size.x, at.y + size.y}, draw.GetClipRectMin(), draw.GetClipRectMax());
}

void text_at(ImDrawList& draw, ImVec2 at, ImU32 colour, const std::string& text) {
  text_at(draw, ImGui::GetFont(), at, colour, text);
}

void shadowed_text(ImDrawList& draw, ImFont* font, ImVec2 at, ImU32 colour, const std::string& text) {
  // A fading text keeps its shadow, else nothing tells it from a ground of its own grey.
  const float alpha = static_cast<float>(colour >> IM_COL32_A_SHIFT) / 255;
  const ImU32 shadow = with_alpha(palette::mark_shadow, std::min(1.0f, 1.4f * alpha));
  // All round: names of landmarks lie over white bone too.
  for (const ImVec2 aside : {ImVec2{1, 1}, ImVec2{-1, 1}, ImVec2{1, -1}, ImVec2{-1, -1}})
    draw.AddText(font, font->FontSize, {at.x + aside.x, at.y + aside.y}, shadow, text.c_str());
  text_at(draw, font, at, colour, text);
}

namespace {

/// Draws `lines`, which are those of `text`.
void put_lines(const std::string& text, const std::string& lines, ImU32 colour) {
  look_for_letters(text);
  ImGui::PushStyleColor(ImGuiCol_Text, colour);
  ImGui::TextUnformatted(lines.c_str());
  ImGui::PopStyleColor();
  const ImDrawList& draw = *ImGui::GetWindowDrawList();
  note_text(text, ImGui::GetItemRectMin(), ImGui::GetItemRectMax(), draw.GetClipRectMin(), draw.GetClipRectMax());
}

}  // namespace

void text_line(const std::string& text, ImU32 colour) {
  put_lines(text, text, colour);
}

void text_lines(const std::string& text, ImU32 colour, float end_px) {
  const float room = end_px > 0 ? end_px - ImGui::GetCursorPosX() : ImGui::GetContentRegionAvail().x;
  put_lines(text, in_lines(ImGui::GetFont(), text, std::max(room, 1.0f)), colour);
}

}  // namespace homolog
