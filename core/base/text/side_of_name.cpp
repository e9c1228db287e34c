#include "core/base/text/side_of_name.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>
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

/// Whether a word is a level of the spine: "l3", "th12".
bool is_level(const std::string& word) {
  const std::size_t letters = std::min(word.find_first_of("0123456789"), word.size());
  const std::string_view region = std::string_view(word).substr(0, letters);
  return (region == "c" || region == "t" || region == "th" || region == "l") && word.size() > letters &&
         as_number<int>(word.substr(letters)).has_value();
}

/// Whether the name is about a level of the spine, where a letter is no side: "L 4", "body L of L3". Of a rib it is
/// one.
bool is_of_level(const std::vector<PlacedWord>& words) {
  if (std::ranges::any_of(words, [](const PlacedWord& word) { return word.text.starts_with("rib"); })) return false;
  for (std::size_t k = 0; k < words.size(); ++k) {
    const bool is_letter = words[k].text == "l" || words[k].text == "r";
    if (is_level(words[k].text) || (is_letter && k + 1 < words.size() && as_number<int>(words[k + 1].text)))
      return true;
  }
  return false;
}

/// The first word that says a side, and which. None where no word does.
std::optional<std::pair<PlacedWord, Side>> word_of_side(const std::string& name) {
  const std::vector<PlacedWord> words = placed_words(name);
  const bool letters_count = !is_of_level(words);
  for (const PlacedWord& word : words) {
    if (word.text == "left" || (word.text == "l" && letters_count)) return std::pair(word, Side::left);
    if (word.text == "right" || (word.text == "r" && letters_count)) return std::pair(word, Side::right);
  }
  return std::nullopt;
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
  const auto found = word_of_side(name);
  return found ? found->second : Side::none;
}

std::string name_of_other_side(const std::string& name) {
  const auto found = word_of_side(name);
  if (!found) return {};
  const auto& [word, side] = *found;
  const bool is_letter = word.text.size() == 1;
  const std::string other = side == Side::left ? (is_letter ? "r" : "right") : (is_letter ? "l" : "left");
  const std::string written = name.substr(word.at, word.text.size());
  return name.substr(0, word.at) + in_case_of(other, written) + name.substr(word.at + written.size());
}

}  // namespace homolog
