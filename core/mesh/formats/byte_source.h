#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/mesh/formats/text.h"

namespace homolog::formats {

/// Bytes that lie in the file as they are or in base64; decoded only as far as they are asked for.
class ByteSource {
 public:
  ByteSource(std::string_view text, bool base64) : text_(text), base64_(base64) {}

  std::optional<std::string_view> take(std::size_t count) {
    if (!base64_) {
      if (count > text_.size() - at_) return std::nullopt;
      at_ += count;
      return text_.substr(at_ - count, count);
    }
    if (count > text_.size()) return std::nullopt;
    while (decoded_.size() - taken_ < count)
      if (!decode_group()) return std::nullopt;
    taken_ += count;
    return std::string_view(decoded_).substr(taken_ - count, count);
  }
  /// How far into its text it has come.
  std::size_t consumed() const { return at_; }

 private:
  static int value_of(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
  }

  /// Four characters to at most three bytes. Groups padded with '=' may stand anywhere: VTK encodes the sizes of
  /// compressed blocks and the blocks one after the other.
  bool decode_group() {
    std::uint32_t bits = 0;
    int digits = 0, padding = 0;
    while (digits + padding < 4) {
      while (at_ < text_.size() && is_space(text_[at_])) ++at_;
      if (at_ == text_.size()) return false;
      const char c = text_[at_++];
      const int value = value_of(c);
      if (c == '=' ? digits < 2 : value < 0 || padding > 0) return false;
      bits = bits << 6 | static_cast<std::uint32_t>(std::max(value, 0));
      ++(c == '=' ? padding : digits);
    }
    for (int byte = 0; byte < digits - 1; ++byte) decoded_ += static_cast<char>(bits >> (16 - 8 * byte) & 255);
    return true;
  }

  std::string_view text_;
  bool base64_;
  std::size_t at_ = 0;
  std::string decoded_;
  std::size_t taken_ = 0;
};

}  // namespace homolog::formats
