#include "core/structures/defects.h"

#include <cctype>

namespace homolog {

namespace {

/// The vertebrae from the head down.
struct Part {
  char letter;
  int first, count;
};
constexpr std::array spine{Part{'C', 0, 7}, Part{'T', 7, 12}, Part{'L', 19, 5}, Part{'S', 24, 1}};

/// Where a name says its level, "L3" or "l3", as a word of its own; npos: nowhere.
std::size_t level_at(const std::string& name) {
  const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; };
  for (std::size_t k = 0; k + 1 < name.size(); ++k) {
    const int letter = std::toupper(static_cast<unsigned char>(name[k]));
    if (letter != 'C' && letter != 'T' && letter != 'L' && letter != 'S') continue;
    if (k > 0 && is_word(name[k - 1])) continue;
    std::size_t end = k + 1;
    while (end < name.size() && std::isdigit(static_cast<unsigned char>(name[end])) != 0) ++end;
    if (end > k + 1 && end <= k + 3 && (end == name.size() || !is_word(name[end]))) return k;
  }
  return std::string::npos;
}

std::size_t digits_from(const std::string& name, std::size_t at) {
  std::size_t end = at;
  while (end < name.size() && std::isdigit(static_cast<unsigned char>(name[end])) != 0) ++end;
  return end - at;
}

}  // namespace

std::optional<DefectKind> defect_of_name(const std::string& name) {
  for (std::size_t k = 0; k < defect_names.size(); ++k)
    if (name == defect_names[k]) return static_cast<DefectKind>(k);
  return std::nullopt;
}

std::optional<int> level_of_name(const std::string& name) {
  const std::size_t at = level_at(name);
  if (at == std::string::npos) return std::nullopt;
  const int number = std::stoi(name.substr(at + 1, digits_from(name, at + 1)));
  // L6 and T13 are variants: they count on, and share their number with what is below.
  for (const Part& part : spine)
    if (part.letter == std::toupper(static_cast<unsigned char>(name[at])) && number >= 1 && number <= part.count + 1)
      return part.first + number - 1;
  return std::nullopt;
}

std::string name_at_level(const std::string& name, int level) {
  const std::size_t at = level_at(name);
  if (at == std::string::npos) return name;
  for (const Part& part : spine) {
    if (level < part.first || level >= part.first + part.count) continue;
    const bool small = std::islower(static_cast<unsigned char>(name[at])) != 0;
    const char letter = small ? static_cast<char>(std::tolower(part.letter)) : part.letter;
    return name.substr(0, at) + letter + std::to_string(level - part.first + 1) +
           name.substr(at + 1 + digits_from(name, at + 1));
  }
  return name;
}

}  // namespace homolog
