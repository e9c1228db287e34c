#include "core/base/text/short_names.h"

#include <algorithm>
#include <optional>
#include <string_view>

namespace homolog {

namespace {

constexpr const char* left_out = "\xe2\x80\xa6";

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

/// The ends shared with names that would look much as `shortened`, which is this one's; nothing where it stands alone.
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
    const bool whole = *longest == letters_to_cut(words[longest - kept.begin()]);
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

/// A name's own part, with as much of what it shares as there is room for; empty where there is too little.
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

/// The ends that all names share, however they are shortened; nothing where there is one only.
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

std::string shortened(const std::string& text, const TextFits& fits) {
  if (text.empty() || fits(text)) return text;
  std::vector<std::size_t> characters;  // the begin of each in UTF-8
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

}  // namespace homolog
