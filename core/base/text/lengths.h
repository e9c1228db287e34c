#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace homolog {

/// A length in a sentence: "2.50 mm" with two decimals.
inline std::string in_mm(double length_mm, int decimals) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f mm", decimals, length_mm);
  return text.data();
}

/// The same by how many digits count: "0.125 mm" and "12.5 mm" with three.
inline std::string in_mm_by_digits(double length_mm, int digits) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*g mm", digits, length_mm);
  return text.data();
}

}  // namespace homolog
