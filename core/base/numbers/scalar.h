#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace homolog {

/// The types of the numbers that files of images, pictures and meshes hold.
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

/// Turns the bytes of each number round; each has `size` bytes.
template <std::size_t size>
void swap_byte_order(std::span<std::byte> numbers) {
  if constexpr (size > 1)
    for (std::size_t at = 0; at + size <= numbers.size(); at += size)
      std::reverse(numbers.data() + at, numbers.data() + at + size);
}
inline void swap_byte_order(std::span<std::byte> numbers, Scalar type) {
  with_type(type, [numbers]<class T>(std::type_identity<T>) { swap_byte_order<sizeof(T)>(numbers); });
}

}  // namespace homolog
