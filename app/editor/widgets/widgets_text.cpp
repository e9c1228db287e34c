#include <algorithm>
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

std::string shortened(const std::string& text, const TextFits& fits) {
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

namespace {

/// Words of letters that are cut short, and what lies between them, which stays.
std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words;
  std::size_t from = 0;
  for (std::size_t at = name.find(' '); at != std::string::npos; at = name.find(' ', from)) {
    words.push_back(name.substr(from, at - from));
    from = at + 1;
  }
  words.push_back(name.substr(from));
  return words;
}

/// Letters of a word that can be cut short; 0 of one that is short already, and of a name of a file: there all counts.
std::size_t letters_to_cut(const std::string& word) {
  constexpr std::ptrdiff_t shortest = 5;
  const bool is_word = std::none_of(word.begin(), word.end(), [](char c) {
    return (c >= '0' && c <= '9') || c == '_' || c == '.' || c == '-' || c == '/';
  });
  const auto letters =
      std::count_if(word.begin(), word.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; });
  return is_word && letters >= shortest ? static_cast<std::size_t>(letters) : 0;
}

std::string first_letters(const std::string& word, std::size_t count) {
  std::size_t at = 0;
  for (; at < word.size(); ++at)
    if (begins_letter(word, at) && count-- == 0) break;
  return word.substr(0, at);
}

/// Whether a name can be read from what is left of its words.
bool is_read_from(const std::string& name, const std::vector<std::string>& cut) {
  const std::vector<std::string> words = words_of(name);
  return std::equal(words.begin(), words.end(), cut.begin(), cut.end(), [](const std::string& word, std::string part) {
    if (!part.ends_with('.')) return word == part;
    part.pop_back();
    return word.starts_with(part) || word == part + ".";
  });
}

/// The name with its longest words cut short, one letter after the other: "body ant. sup.". Empty where that does not
/// fit, or where it could be one of the other names as well.
std::string with_short_words(const std::string& name, const std::vector<std::string>& names, const TextFits& fits) {
  constexpr std::size_t least = 3;
  const std::vector<std::string> words = words_of(name);
  if (words.size() < 2) return {};
  std::vector<std::size_t> kept;
  for (const std::string& word : words) kept.push_back(letters_to_cut(word));
  for (;;) {
    const auto longest = std::max_element(kept.begin(), kept.end());
    if (*longest <= least) return {};
    // A dot takes the place of a letter.
    const bool whole = *longest == letters_to_cut(words[static_cast<std::size_t>(longest - kept.begin())]);
    *longest = std::max(least, *longest - (whole ? 2 : 1));
    std::vector<std::string> cut;
    std::string text;
    for (std::size_t k = 0; k < words.size(); ++k) {
      const bool is_cut = kept[k] < letters_to_cut(words[k]);
      cut.push_back(is_cut ? first_letters(words[k], kept[k]) + "." : words[k]);
      text += (k > 0 ? " " : "") + cut.back();
    }
    if (!fits(text)) continue;
    const bool other = std::any_of(names.begin(), names.end(),
                                   [&](const std::string& one) { return one != name && is_read_from(one, cut); });
    return other ? std::string() : text;
  }
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// The same without parts of numbers: what is shared ends where a number of the name's own begins.
Shared outside_numbers(Shared shared, const std::string& name) {
  while (shared.head > 0 && shared.head < name.size() && is_digit(name[shared.head - 1]) && is_digit(name[shared.head]))
    --shared.head;
  while (shared.tail > 0 && shared.tail < name.size() && is_digit(name[name.size() - shared.tail]) &&
         is_digit(name[name.size() - shared.tail - 1]))
    --shared.tail;
  return shared;
}

/// What a name has of its own, with as much of what it shares as there is room for; empty where there is too little.
std::string own_part(const std::string& name, const Shared& shared, const TextFits& fits) {
  const std::string own = name.substr(shared.head, name.size() - shared.tail - shared.head);
  const std::string after = shared.tail > 0 ? left_out : "";
  std::string best;
  // With the whole beginning, and of the end what there is room for.
  for (std::size_t kept = 0; kept < shared.tail; ++kept) {
    if (!begins_letter(name, name.size() - kept)) continue;
    const std::string text = name.substr(0, name.size() - shared.tail) + left_out + name.substr(name.size() - kept);
    if (!fits(text)) break;
    best = text;
  }
  if (!best.empty()) return best;
  // Else with as much of the beginning as there is room for.
  for (std::size_t kept = 0; kept <= shared.head; ++kept) {
    if (!begins_letter(name, kept)) continue;
    const std::string text = name.substr(0, kept) + (kept < shared.head ? left_out : "") + own + after;
    if (!fits(text)) break;
    best = text;
  }
  return best;
}

/// The number that what a name has of its own begins with, whole, and of what follows as much as there is room for;
/// empty where it begins with none, or where that does not fit.
std::string own_number(const std::string& name, const Shared& shared, const TextFits& fits) {
  const std::string own = name.substr(shared.head), before = shared.head > 0 ? left_out : "";
  std::size_t digits = 0;
  while (digits < own.size() && is_digit(own[digits])) ++digits;
  for (std::size_t kept = own.size(); digits > 0 && kept-- > digits;) {
    const std::string text = before + own.substr(0, kept) + left_out;
    if (begins_letter(own, kept) && fits(text)) return text;
  }
  const std::string alone = before + own.substr(0, digits) + left_out;
  return digits > 0 && fits(alone) ? alone : std::string();
}

/// What all names share, however they are shortened; nothing where there is one only.
std::optional<Shared> shared_by_all(const std::string& name, const std::vector<std::string>& names) {
  std::optional<Shared> shared;
  for (const std::string& other : names) {
    if (other == name) continue;
    if (!shared) shared.emplace();
    shared->with(name, other);
  }
  return shared;
}

}  // namespace

std::string shortened_among(const std::string& name, const std::vector<std::string>& names, const TextFits& fits) {
  const std::string alone = shortened(name, fits);
  if (alone == name) return name;
  if (std::string words = with_short_words(name, names, fits); !words.empty()) return words;
  const auto like_it = shared_ends(name, names, alone);
  const auto shared = like_it ? like_it : shared_by_all(name, names);
  if (!shared || shared->head + shared->tail == 0) return alone;
  const Shared whole = outside_numbers(*shared, name);
  if (std::string own = own_part(name, whole, fits); !own.empty()) return own;
  if (std::string number = own_number(name, whole, fits); !number.empty()) return number;
  if (std::string own = own_part(name, *shared, fits); !own.empty()) return own;
  const bool alike = std::any_of(names.begin(), names.end(), [&](const std::string& other) {
    return other != name && shortened(other, fits) == alone;
  });
  if (!alike) return alone;
  for (const Shared& ends : {outside_numbers(*shared, name), *shared}) {
    const std::string own = name.substr(ends.head, name.size() - ends.tail - ends.head);
    if (fits(own)) return own;
  }
  return shortened(name.substr(shared->head, name.size() - shared->tail - shared->head), fits);
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
  const ImU32 shadow = with_alpha(palette::mark_shadow, static_cast<float>(colour >> IM_COL32_A_SHIFT) / 255);
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
