#include "core/case/packed.h"

#include <doctest/doctest.h>

#include <bit>
#include <random>

namespace homolog {

TEST_CASE("packed numbers read back to the last bit and damage is refused") {
  std::mt19937_64 random(1);
  for (const std::size_t count : {0, 1, 2, 3, 1000}) {
    std::vector<double> doubles(count);
    std::vector<std::uint32_t> whole(count);
    std::vector<std::uint8_t> bytes(count);
    for (std::size_t k = 0; k < count; ++k) {
      doubles[k] = std::bit_cast<double>(random() >> 2);
      whole[k] = static_cast<std::uint32_t>(random() >> (random() % 64));
      bytes[k] = static_cast<std::uint8_t>(random() % 3);
    }
    CHECK(unpacked<double>(packed<double>(doubles), count).value() == doubles);
    CHECK(unpacked<std::uint32_t>(packed<std::uint32_t>(whole), count).value() == whole);
    CHECK(unpacked<std::uint8_t>(packed<std::uint8_t>(bytes), count).value() == bytes);
    CHECK_FALSE(unpacked<double>(packed<double>(doubles), count + 1));
    CHECK_FALSE(unpacked<double>(packed<double>(doubles), std::size_t{1} << 40));
  }
  std::vector<std::uint32_t> whole(1000);
  for (auto& one : whole) one = static_cast<std::uint32_t>(random());
  const std::string text = packed<std::uint32_t>(whole);
  for (int k = 0; k < 200; ++k) {
    std::string damaged = text;
    damaged[random() % damaged.size()] = "AZaz09+/=\n\"x"[random() % 12];
    const auto read = unpacked<std::uint32_t>(damaged, whole.size());
    if (read) CHECK(*read == whole);  // the last letter may have bits to spare
    CHECK_FALSE(unpacked<std::uint32_t>(text.substr(0, random() % text.size()), whole.size()));
  }
}

}  // namespace homolog
