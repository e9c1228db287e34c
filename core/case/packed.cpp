#include "core/case/packed.h"

#include <zlib.h>

#include <array>
#include <bit>
#include <cstdint>
#include <new>
#include <type_traits>

#include "core/base/encoding/base64.h"

namespace homolog {

namespace {

/// Runs and unequal frequencies are all there is to gain in the planes: no search for longer repeats, which costs the
/// most.
std::vector<unsigned char> deflated(std::vector<unsigned char> bytes) {
  z_stream stream{};
  constexpr int level = 6, window = 15, memory = 9;
  if (deflateInit2(&stream, level, Z_DEFLATED, window, memory, Z_RLE) != Z_OK) throw std::bad_alloc();
  std::vector<unsigned char> smaller(deflateBound(&stream, static_cast<uLong>(bytes.size())));
  stream.next_in = bytes.data();
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = smaller.data();
  stream.avail_out = static_cast<uInt>(smaller.size());
  deflate(&stream, Z_FINISH);
  smaller.resize(stream.total_out);
  deflateEnd(&stream);
  return smaller;
}

template <class Number>
using Bits = std::conditional_t<std::is_same_v<Number, double>, std::uint64_t, Number>;

}  // namespace

template <class Number>
std::string packed(std::span<const Number> numbers) {
  std::vector<unsigned char> planes(numbers.size() * sizeof(Number));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto bits = std::bit_cast<Bits<Number>>(numbers[i]);
    for (std::size_t plane = 0; plane < sizeof(Number); ++plane)
      planes[plane * numbers.size() + i] = static_cast<unsigned char>(bits >> (8 * plane));
  }
  return to_base64(deflated(std::move(planes)));
}

template <class Number>
Result<std::vector<Number>> unpacked(std::string_view text, std::size_t count) {
  constexpr std::size_t most_to_1 = 1032;  // zlib's limit: a larger claim is not worth the memory
  const std::vector<unsigned char> bytes = from_base64(text);
  if (bytes.empty() || count > most_to_1 * bytes.size() / sizeof(Number))
    return fail("", "holds packed numbers that are damaged");
  std::vector<unsigned char> planes(count * sizeof(Number));
  uLongf size = static_cast<uLongf>(planes.size());
  if (uncompress(planes.data(), &size, bytes.data(), static_cast<uLong>(bytes.size())) != Z_OK || size != planes.size())
    return fail("", "holds packed numbers that are damaged or of another count");
  std::vector<Number> numbers(count);
  for (std::size_t i = 0; i < count; ++i) {
    Bits<Number> bits = 0;
    for (std::size_t plane = 0; plane < sizeof(Number); ++plane)
      bits = static_cast<Bits<Number>>(bits | static_cast<Bits<Number>>(planes[plane * count + i]) << (8 * plane));
    numbers[i] = std::bit_cast<Number>(bits);
  }
  return numbers;
}

template std::string packed(std::span<const std::uint8_t>);
template std::string packed(std::span<const std::uint32_t>);
template std::string packed(std::span<const double>);
template Result<std::vector<std::uint8_t>> unpacked(std::string_view, std::size_t);
template Result<std::vector<std::uint32_t>> unpacked(std::string_view, std::size_t);
template Result<std::vector<double>> unpacked(std::string_view, std::size_t);

}  // namespace homolog
