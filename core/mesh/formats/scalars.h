#pragma once

#include <algorithm>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

/// Numbers as they lie in binary files.
namespace homolog::formats {

enum class Scalar { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

/// Calls `use` with std::type_identity of the C++ type of `scalar`.
template <class Use>
auto with_type(Scalar scalar, const Use& use) {
  switch (scalar) {
    case Scalar::int8:
      return use(std::type_identity<std::int8_t>());
    case Scalar::uint8:
      return use(std::type_identity<std::uint8_t>());
    case Scalar::int16:
      return use(std::type_identity<std::int16_t>());
    case Scalar::uint16:
      return use(std::type_identity<std::uint16_t>());
    case Scalar::int32:
      return use(std::type_identity<std::int32_t>());
    case Scalar::uint32:
      return use(std::type_identity<std::uint32_t>());
    case Scalar::int64:
      return use(std::type_identity<std::int64_t>());
    case Scalar::uint64:
      return use(std::type_identity<std::uint64_t>());
    case Scalar::float32:
      return use(std::type_identity<float>());
    case Scalar::float64:
      break;
  }
  return use(std::type_identity<double>());
}

inline bool is_integer(Scalar scalar) {
  return scalar != Scalar::float32 && scalar != Scalar::float64;
}

inline std::size_t size_of(Scalar scalar) {
  return with_type(scalar, []<class T>(std::type_identity<T>) { return sizeof(T); });
}

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
