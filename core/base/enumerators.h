#pragma once

#include <cstddef>
#include <functional>
#include <string_view>
#include <type_traits>

namespace homolog {

// Tables with a row for each value of an enumeration say by a static_assert that none is missing. The values of such an
// enumeration are 0, 1, 2 ….

/// Whether a value has a name in its enumeration. GCC and clang write one without a name as a cast: "(Tool)4".
template <auto value>
consteval bool is_enumerator() {
  static_assert(std::is_enum_v<decltype(value)>);
  const std::string_view text = __PRETTY_FUNCTION__;
  const std::size_t cast = text.rfind(')');
  return cast == std::string_view::npos || cast + 1 == text.size() || text[cast + 1] < '0' || text[cast + 1] > '9';
}

/// How many values an enumeration has.
template <class Enum, std::size_t known = 0>
consteval std::size_t enumerators() {
  if constexpr (is_enumerator<static_cast<Enum>(known)>())
    return enumerators<Enum, known + 1>();
  else
    return known;
}

/// Whether the rows of a table stand in the order of an enumeration, a row for each value. `value_of`: a function, or
/// a member, that tells a row's value.
template <class Enum, class Rows, class ValueOf>
constexpr bool has_row_of_each(const Rows& rows, const ValueOf& value_of) {
  if (rows.size() != enumerators<Enum>()) return false;
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (std::invoke(value_of, rows[k]) != static_cast<Enum>(k)) return false;
  return true;
}

}  // namespace homolog
