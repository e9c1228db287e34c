#include "core/structures/naming/level_names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/text/text.h"

namespace homolog {

namespace {

/// The vertebrae from the head down.
struct Part {
  char letter;
  int first, count;
};
constexpr Part thoracic{'T', 7, 12};
constexpr std::array spine{Part{'C', 0, 7}, thoracic, Part{'L', 19, 5}, Part{'S', 24, 1}};

bool is_digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}
bool is_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0;
}

/// A part of a name that says a level.
struct LevelWord {
  std::size_t at = 0, length = 0;
  int level = 0;
  char letter = 0;  ///< as it is written; 0: a number alone, as ribs have it
};

/// "L3", "l3" or "T12", as a word of its own.
std::vector<LevelWord> lettered_levels(const std::string& name) {
  std::vector<LevelWord> words;
  for (std::size_t at = 0; at < name.size(); ++at) {
    if (!is_word(name[at]) || (at > 0 && is_word(name[at - 1]))) continue;
    std::size_t end = at;
    while (end < name.size() && is_word(name[end])) ++end;
    const std::string word = name.substr(at, end - at), digits = word.substr(1);
    const auto number =
        digits.size() < 3 && std::ranges::all_of(digits, is_digit) ? as_number<int>(digits) : std::nullopt;
    for (const Part& part : spine)
      if (number && part.letter == std::toupper(static_cast<unsigned char>(word[0])) && *number >= 1 &&
          *number <= part.count + 1)
        words.push_back({at, word.size(), part.first + *number - 1, word[0]});
  }
  return words;
}

/// "rib_left_12", "Rib 3".
std::vector<LevelWord> rib_level(const std::string& name) {
  const std::size_t rib = lower_case(name).find("rib");
  if (rib == std::string::npos || (rib > 0 && is_word(name[rib - 1]))) return {};
  std::size_t at = name.size();
  while (at > 0 && is_digit(name[at - 1])) --at;
  const auto number = as_number<int>(name.substr(at));
  if (!number || *number < 1 || *number > thoracic.count + 1) return {};
  return {{at, name.size() - at, thoracic.first + *number - 1, 0}};
}

std::vector<LevelWord> level_words(const std::string& name) {
  auto words = lettered_levels(name);
  return words.empty() ? rib_level(name) : words;
}

/// The vertebra that a name calls, as its letter and its level. None where the name is of a part of it or of more.
std::optional<std::pair<int, int>> vertebra_in(const std::string& name) {
  static constexpr std::array<std::string_view, 5> vertebra{"", "vert", "vertebra", "vertebrae", "wirbel"};
  const auto words = lettered_levels(name);
  if (words.size() != 1) return std::nullopt;
  const LevelWord& word = words.front();
  std::string rest = lower_case(name.substr(0, word.at) + name.substr(word.at + word.length));
  std::erase_if(rest, [](char c) { return std::string_view(" _-.,()/").find(c) != std::string_view::npos; });
  if (std::ranges::find(vertebra, rest) == vertebra.end()) return std::nullopt;
  return std::pair(std::toupper(static_cast<unsigned char>(word.letter)), word.level);
}

std::string word_at(const LevelWord& word, int level) {
  if (word.letter == 0) return std::to_string(level - thoracic.first + 1);
  const bool small = std::islower(static_cast<unsigned char>(word.letter)) != 0;
  for (const Part& part : spine)
    if (level >= part.first && level < part.first + part.count) {
      const char letter = small ? static_cast<char>(std::tolower(part.letter)) : part.letter;
      return letter + std::to_string(level - part.first + 1);
    }
  return {};
}

}  // namespace

std::optional<LevelName> level_in_name(const std::string& name) {
  const auto words = level_words(name);
  if (words.empty()) return std::nullopt;
  LevelName found{name, words.front().level, std::toupper(static_cast<unsigned char>(words.front().letter)) == 'S'};
  for (std::size_t k = words.size(); k-- > 0;) found.family.replace(words[k].at, words[k].length, "#");
  found.family = lower_case(found.family);
  return found;
}

std::optional<int> level_of_name(const std::string& name) {
  const auto found = level_in_name(name);
  return found ? std::optional(found->level) : std::nullopt;
}

bool is_same_vertebra(const std::string& a, const std::string& b) {
  const auto one = vertebra_in(a);
  return one && one == vertebra_in(b);
}

std::string name_at_level(const std::string& name, int level) {
  const auto words = level_words(name);
  std::string changed = name;
  for (std::size_t k = words.size(); k-- > 0;) {
    const std::string word = word_at(words[k], words[k].level + level - words.front().level);
    if (word.empty()) return name;
    changed.replace(words[k].at, words[k].length, word);
  }
  return changed;
}

}  // namespace homolog
