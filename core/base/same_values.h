#pragma once

#include <memory>
#include <utility>

namespace homolog {

/// Whether two pointers point at equal values, or both at nothing.
bool same_values(const auto& a, const auto& b) {
  return a == b || (a && b && *a == *b);
}

/// A shared pointer that compares what it points at. With it as a member a struct has its == by default.
template <class T>
struct SharedValue : std::shared_ptr<const T> {
  using Pointer = std::shared_ptr<const T>;
  SharedValue() = default;
  template <class U>
  SharedValue(std::shared_ptr<U> pointer) : Pointer(std::move(pointer)) {}

  bool operator==(const SharedValue& other) const {
    return same_values(static_cast<const Pointer&>(*this), static_cast<const Pointer&>(other));
  }
};

/// A shared pointer that is equal to any other: what a struct holds beside its values. So the struct has its == by
/// default.
template <class T>
struct BesideValues : std::shared_ptr<const T> {
  using Pointer = std::shared_ptr<const T>;
  BesideValues() = default;
  template <class U>
  BesideValues(std::shared_ptr<U> pointer) : Pointer(std::move(pointer)) {}

  bool operator==(const BesideValues&) const { return true; }
};

}  // namespace homolog
