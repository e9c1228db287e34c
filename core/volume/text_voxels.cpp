#include "core/volume/text_voxels.h"

#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>
#include <type_traits>

#include "core/base/files/files.h"
#include "core/base/processes/memory.h"

namespace homolog {

namespace {

/// A number of the type; false where the text is none or lies outside of it. Whole numbers may be written "12.0".
template <class T>
bool parse_number(std::string_view text, T& number) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const char *begin = text.data(), *end = begin + text.size();
  const auto [rest, error] = std::from_chars(begin, end, number);
  if (error == std::errc() && rest == end) return true;
  if constexpr (std::is_integral_v<T>) {
    double value = 0;
    const auto [rest_of_real, error_of_real] = std::from_chars(begin, end, value);
    // Beyond 2^53 a real number does not tell which whole one is meant.
    constexpr double exact = 9007199254740992.0;
    if (error_of_real != std::errc() || rest_of_real != end || value != std::floor(value) || std::abs(value) > exact ||
        value < static_cast<double>(std::numeric_limits<T>::min()) ||
        value > static_cast<double>(std::numeric_limits<T>::max()))
      return false;
    number = static_cast<T>(value);
    return true;
  } else {
    return false;
  }
}

template <class T>
bool parse_numbers(std::string_view text, std::size_t count, std::vector<T>& values) {
  constexpr std::string_view between = " \t\r\n\v\f,";
  for (std::size_t i = 0; i < count; ++i) {
    text.remove_prefix(std::min(text.find_first_not_of(between), text.size()));
    const std::string_view word = text.substr(0, text.find_first_of(between));
    if (word.empty() || !parse_number(word, values.emplace_back())) return false;
    text.remove_prefix(word.size());
  }
  return true;
}

int digit_of(char c) {
  return c >= '0' && c <= '9'   ? c - '0'
         : c >= 'a' && c <= 'f' ? c - 'a' + 10
         : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                : -1;
}

/// Whether more digits follow the `count` of a text in numbers or hexadecimal digits.
bool holds_more(std::string_view text, VoxelText form, std::size_t count) {
  constexpr std::string_view between = " \t\r\n\v\f,";
  for (std::size_t begin = 0; (begin = text.find_first_not_of(between, begin)) != std::string_view::npos;) {
    const auto end = std::min(text.find_first_of(between, begin), text.size());
    const std::size_t found = form == VoxelText::Hex ? (end - begin) : 1;
    if (found > count) return true;
    count -= found;
    begin = end;
  }
  return false;
}

bool parse_hex(std::string_view text, std::span<std::byte> bytes) {
  std::size_t digits = 0;
  for (std::size_t i = 0; i < text.size() && digits < 2 * bytes.size(); ++i) {
    const int digit = digit_of(text[i]);
    if (digit < 0 && text[i] != ' ' && text[i] != '\n' && text[i] != '\r' && text[i] != '\t') return false;
    if (digit < 0) continue;
    std::byte& byte = bytes[digits++ / 2];
    byte = byte << 4 | static_cast<std::byte>(digit);
  }
  return digits == 2 * bytes.size();
}

tl::unexpected<Error> bad_text(const std::filesystem::path& file) {
  return fail(file.string(),
              "is cut short or damaged: its text does not hold the voxels its header claims; export it again");
}

}  // namespace

Result<StoredVoxels> read_text_voxels(const VoxelRun& run, VoxelText form, const VolumeGeometry& geometry,
                                      std::int64_t frames) {
  const double voxels = claimed_voxels(geometry, frames);
  const auto value_bytes = static_cast<double>(size_of(run.type));
  // A number takes a digit and a separator, the last one perhaps only the digit.
  const double characters = form == VoxelText::Hex ? 2 * value_bytes * voxels : 2 * voxels - 1;
  double present = 0;
  for (const ByteBlock& block : run.blocks) {
    const auto size = size_of_file(block.file);
    if (!size) return fail(size.error());
    present += static_cast<double>(*size) - static_cast<double>(block.offset);
  }
  const auto& first = run.blocks.front().file;
  if (present < characters) return bad_text(first);
  if (const auto enough = check_memory(first, present + bytes_while_reading(run.type, voxels, false)); !enough)
    return fail(enough.error());
  StoredVoxels stored = make_stored_voxels(run.type, 0);
  const std::size_t count = geometry.voxels() * static_cast<std::size_t>(frames), each = count / run.blocks.size();
  if (count % run.blocks.size() != 0) return bad_text(first);
  reserve_voxels(stored, count);
  for (const ByteBlock& block : run.blocks) {
    const auto text = read_to_end(block, static_cast<std::uintmax_t>(present));
    if (!text) return fail(text.error());
    const bool parsed = form == VoxelText::Hex
                            ? parse_hex(*text, add_voxels(stored, each))
                            : std::visit([&](auto& values) { return parse_numbers(*text, each, values); }, stored);
    if (!parsed) return bad_text(block.file);
    if (holds_more(*text, form, form == VoxelText::Hex ? 2 * each * size_of(run.type) : each))
      return fail(block.file.string(), more_voxels_than_said);
  }
  if (form == VoxelText::Hex && run.other_byte_order) swap_byte_order(stored);
  return stored;
}

}  // namespace homolog
