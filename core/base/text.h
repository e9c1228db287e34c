#pragma once

#include <string>

namespace homolog {

/// A to Z in lower case, everything else as it is: file name endings and searches, the same in every locale.
inline std::string lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

}  // namespace homolog
