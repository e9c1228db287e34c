#pragma once

#include <cstddef>
#include <string_view>
#include <tuple>
#include <type_traits>

namespace homolog {

// Lists that name each member of a struct once. A list is a tuple of rows. A row is a pointer to a member, or holds one
// as `of`, with the member's `key`. `names_all` says at compile time whether a list is complete.

/// Calls `visit(row)` for each row of a list, in its order.
template <class List, class Visit>
constexpr void for_each_member(const List& list, const Visit& visit) {
  std::apply([&](const auto&... row) { (visit(row), ...); }, list);
}

namespace member_list {

struct Anything {
  template <class T>
  operator T() const;  // NOLINT(google-explicit-constructor): it stands for a value of any member
};

/// How many members an aggregate has: with how many values it can be made.
template <class T, class... Known>
consteval std::size_t count_of() {
  if constexpr (requires { T{Known{}..., Anything{}}; })
    return count_of<T, Known..., Anything>();
  else
    return sizeof...(Known);
}

/// The member that a row names.
template <class Row>
constexpr auto pointer_of(const Row& row) {
  if constexpr (std::is_member_object_pointer_v<Row>)
    return row;
  else
    return row.of;
}

template <class One, class Other>
constexpr bool differ(const One& one, const Other& other) {
  const auto a = pointer_of(one);
  const auto b = pointer_of(other);
  if constexpr (std::is_same_v<decltype(a), decltype(b)>)
    if (a == b) return false;
  if constexpr (requires { std::string_view(one.key) == std::string_view(other.key); })
    return std::string_view(one.key) != std::string_view(other.key);
  return true;
}

/// Whether the first row differs from all others, and they from each other.
constexpr bool all_differ() {
  return true;
}
template <class First, class... Others>
constexpr bool all_differ(const First& first, const Others&... others) {
  return (differ(first, others) && ...) && all_differ(others...);
}

}  // namespace member_list

/// Whether a list names every member of an aggregate, and none twice; nor does any key stand twice.
template <class Owner, class List>
constexpr bool names_all(const List& list) {
  return member_list::count_of<Owner>() == std::tuple_size_v<List> &&
         std::apply([](const auto&... rows) { return member_list::all_differ(rows...); }, list);
}

}  // namespace homolog
