#include "core/base/text/side_of_name.h"

#include <algorithm>
#include <string_view>
#include <vector>

#include "core/base/text/text.h"

namespace homolog {

namespace {

/// A word of a name, and where it stands.
struct PlacedWord {
  std::string text;  ///< in small letters
  std::size_t at = 0;
};

std::vector<PlacedWord> placed_words(const std::string& name) {
  std::vector<PlacedWord> words;
  for (std::size_t k = 0; k < name.size(); ++k) {
    if (std::string_view(" _-.,()/").find(name[k]) != std::string_view::npos) continue;
    if (words.empty() || words.back().at + words.back().text.size() != k) words.push_back({{}, k});
    words.back().text += lower_case(name.substr(k, 1));
  }
  return words;
}

Side side_of_word(const std::string& word) {
  if (word == "left" || word == "l") return Side::left;
  return word == "right" || word == "r" ? Side::right : Side::none;
}

/// `text` with the capitals that `like` has.
std::string in_case_of(const std::string& text, const std::string& like) {
  std::string cased = text;
  const auto upper = [](char c) { return c >= 'A' && c <= 'Z'; };
  const auto to_upper = [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; };
  if (!upper(like.front())) return cased;
  cased.front() = to_upper(cased.front());
  if (upper(like.back())) std::ranges::transform(cased, cased.begin(), to_upper);
  return cased;
}

}  // namespace

Side side_in(const std::string& name) {
  for (const PlacedWord& word : placed_words(name))
    if (const Side side = side_of_word(word.text); side != Side::none) return side;
  return Side::none;
}

std::string name_of_other_side(const std::string& name) {
  for (const PlacedWord& word : placed_words(name)) {
    const Side side = side_of_word(word.text);
    if (side == Side::none) continue;
    const bool is_letter = word.text.size() == 1;
    const std::string other = side == Side::left ? (is_letter ? "r" : "right") : (is_letter ? "l" : "left");
    const std::string written = name.substr(word.at, word.text.size());
    return name.substr(0, word.at) + in_case_of(other, written) + name.substr(word.at + written.size());
  }
  return {};
}

}  // namespace homolog
