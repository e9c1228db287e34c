#pragma once

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/text/text.h"

/// Walking through the text of a whole file.
namespace homolog::formats {

inline bool is_space(char c) {
  return c == ' ' || c == '\n' || c == '\r' || c == '\t' || c == '\f' || c == '\v';
}

/// A whole word as a number; a leading '+' is allowed.
template <class T>
std::optional<T> to_number(std::string_view word) {
  if (word.size() > 1 && word.front() == '+' && word[1] != '-') word.remove_prefix(1);
  return as_number<T>(word);
}

/// Appends the shortest decimal text that reads back as the same number.
template <class T>
void append_number(T value, std::string& text) {
  char digits[32];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

class Text {
 public:
  explicit Text(std::string_view bytes) : bytes_(bytes) {}

  /// The next word, white space skipped; empty at the end.
  std::string_view word() {
    while (at_ < bytes_.size() && is_space(bytes_[at_])) ++at_;
    const std::size_t start = at_;
    while (at_ < bytes_.size() && !is_space(bytes_[at_])) ++at_;
    return bytes_.substr(start, at_ - start);
  }
  /// The next word as a number; none where it is not one.
  template <class T>
  std::optional<T> number() {
    return to_number<T>(word());
  }
  /// The rest of the line, its end taken too but not returned.
  std::string_view line() {
    const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
    std::string_view text = bytes_.substr(at_, end - at_);
    at_ = std::min(end + 1, bytes_.size());
    if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
    return text;
  }
  /// The next `count` bytes as they are; none where fewer are left.
  std::optional<std::string_view> take(std::size_t count) {
    if (count > remaining()) return std::nullopt;
    at_ += count;
    return bytes_.substr(at_ - count, count);
  }
  std::size_t remaining() const { return bytes_.size() - at_; }
  /// How many bytes were taken.
  std::size_t position() const { return at_; }
  /// Whether a word ended at the end of the file without a line break behind it: it may have lost its last digits.
  bool may_be_cut() const { return at_ == bytes_.size() && !bytes_.empty() && !is_space(bytes_.back()); }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
};

/// Warns where the text may have been cut within its last number.
inline void warn_if_cut(const Text& text, std::vector<std::string>& warnings) {
  if (text.may_be_cut())
    warnings.emplace_back("the file ends without a line break and may have been cut off; compare it with its source");
}

}  // namespace homolog::formats
