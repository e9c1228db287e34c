#pragma once

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

}  // namespace homolog
