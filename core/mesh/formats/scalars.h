#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/base/numbers/scalar.h"

/// Numbers as they lie in binary files.
namespace homolog::formats {

/// The number at `bytes`, which is stored in the byte order `order`.
template <class T>
T load(const char* bytes, std::endian order) {
  char copy[sizeof(T)];
  std::memcpy(copy, bytes, sizeof(T));
  if (order != std::endian::native) std::reverse(copy, copy + sizeof(T));
  T value;
  std::memcpy(&value, copy, sizeof(T));
  return value;
}

/// Appends `value` to `bytes` in the byte order `order`.
template <class T>
void store(T value, std::endian order, std::string& bytes) {
  char copy[sizeof(T)];
  std::memcpy(copy, &value, sizeof(T));
  if (order != std::endian::native) std::reverse(copy, copy + sizeof(T));
  bytes.append(copy, sizeof(T));
}

/// All numbers in `bytes`, converted to `To`.
template <class To>
std::vector<To> load_all(std::string_view bytes, Scalar scalar, std::endian order) {
  return with_type(scalar, [&]<class T>(std::type_identity<T>) {
    std::vector<To> values(bytes.size() / sizeof(T));
    for (std::size_t i = 0; i < values.size(); ++i)
      // NOLINTNEXTLINE(bugprone-signed-char-misuse): int8 holds numbers here, not characters
      values[i] = static_cast<To>(load<T>(bytes.data() + i * sizeof(T), order));
    return values;
  });
}

}  // namespace homolog::formats
