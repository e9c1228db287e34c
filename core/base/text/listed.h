#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace homolog {

/// "a, b or c" of a, b and c, where `last` is " or ".
inline std::string listed(const std::vector<std::string>& words, std::string_view last) {
  std::string list;
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (k > 0) list += k + 1 == words.size() ? last : ", ";
    list += words[k];
  }
  return list;
}

/// The first `most` words with commas between them, and how many more there are.
inline std::string some_of(const std::vector<std::string>& words, std::size_t most = 6) {
  std::string text;
  for (std::size_t k = 0; k < std::min(most, words.size()); ++k) text += (k > 0 ? ", " : "") + words[k];
  return words.size() > most ? text + " and " + std::to_string(words.size() - most) + " more" : text;
}

}  // namespace homolog
