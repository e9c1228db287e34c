#pragma once

#include <cstdint>
#include <string>

namespace homolog {

/// A short name for data, which is the same on every machine: FNV-1a of 64 bits. Somebody who wants
/// to can make other data of the same name.
struct Hash {
  std::uint64_t value = 0xcbf29ce484222325U;

  /// Takes in a byte, or a longer word in one step.
  void add(std::uint64_t word) { value = (value ^ word) * 0x100000001b3U; }

  /// 16 digits, the highest first.
  std::string hex() const {
    std::string text(16, '0');
    std::uint64_t left = value;
    for (std::size_t digit = 16; digit-- > 0; left >>= 4) text[digit] = "0123456789abcdef"[left & 15];
    return text;
  }
};

}  // namespace homolog
