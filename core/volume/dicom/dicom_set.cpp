#include "core/volume/dicom/dicom_set.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string_view>

#include "core/base/files/files.h"
#include "core/base/text/text.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

constexpr DicomTag item_tag = 0xfffee000, item_end = 0xfffee00d, sequence_end = 0xfffee0dd, pixel_data = 0x7fe00010;
constexpr DicomTag transfer_syntax_tag = 0x00020010, shared_groups = 0x52009229, plane_groups = 0x52009230,
                   contour_data = 0x30060050;
constexpr std::uint32_t undefined_length = 0xffffffff;
constexpr std::uint32_t longest_value = 1 << 16;
constexpr int deepest = 32;

constexpr std::string_view deflated_syntax = "1.2.840.10008.1.2.1.99", big_endian_syntax = "1.2.840.10008.1.2.2",
                           implicit_syntax = "1.2.840.10008.1.2";

/// Whether the structure of a file of a transfer syntax can be followed: of the standard's [DICOM PS3.5, A], whose
/// compressed ones are all explicit and little-endian. A private one may be anything.
bool is_known_syntax(std::string_view uid) {
  constexpr std::array known{implicit_syntax,
                             std::string_view("1.2.840.10008.1.2.1"),
                             std::string_view("1.2.840.10008.1.2.1.98"),
                             deflated_syntax,
                             big_endian_syntax,
                             std::string_view("1.2.840.10008.1.2.5"),
                             std::string_view("1.2.840.10008.1.2.8.1")};
  return uid.starts_with("1.2.840.10008.1.2.4.") || std::ranges::find(known, uid) != known.end();
}

/// Sequences that a file without type marks does not declare but that are needed: functional groups and their parts,
/// those of segmentations (group 62) and those of contours (group 3006).
constexpr std::array<DicomTag, 30> known_sequences{
    0x00081115, 0x0008114a, 0x00082112, 0x00089124, 0x30060016,    0x00189114,  0x00189117, 0x00189118,
    0x00209111, 0x00209113, 0x00209116, 0x00209253, 0x00209310,    0x00283000,  0x00289110, 0x00289132,
    0x00289145, 0x00480008, 0x0048021a, 0x00620002, 0x0062000a,    0x30060010,  0x30060012, 0x30060014,
    0x30060020, 0x30060039, 0x30060040, 0x30060080, shared_groups, plane_groups};

/// The red, green or blue of a palette: of at most 65,536 entries of two bytes.
bool is_palette(DicomTag tag) {
  return tag >= 0x00281201 && tag <= 0x00281203;
}

bool is_known_sequence(DicomTag tag) {
  return std::find(known_sequences.begin(), known_sequences.end(), tag) != known_sequences.end();
}

class Parser {
 public:
  Parser(std::istream& in, std::uint64_t end, DicomSet& set) : in_(in), end_(end), set_(set) {}

  std::uint64_t position() const { return position_; }
  bool skip(std::uint64_t count, std::uint64_t end) {
    if (count > end - position_) return false;
    position_ += count;
    in_.seekg(static_cast<std::streamoff>(position_));
    return true;
  }

  /// The elements of group 2, always explicit and little-endian; what follows it is where the data set begins.
  bool read_meta(DicomItem& meta) {
    explicit_vr_ = true;
    while (end_ - position_ >= 8) {
      const std::uint64_t before = position_;
      const auto tag = read_tag(end_);
      if (!tag || *tag >> 16 != 2) {
        position_ = before;
        in_.seekg(static_cast<std::streamoff>(before));
        return true;
      }
      if (!read_element(*tag, end_, meta, 0)) return false;
    }
    return true;
  }

  bool read_data_set(bool explicit_vr, bool big_endian) {
    explicit_vr_ = explicit_vr;
    swap_ = big_endian != (std::endian::native == std::endian::big);
    return read_elements(end_, set_.elements, 0, false);
  }

 private:
  template <class T>
  std::optional<T> read_number(std::uint64_t end) {
    std::array<char, sizeof(T)> bytes;
    if (end - position_ < sizeof(T) || !in_.read(bytes.data(), sizeof(T))) return {};
    position_ += sizeof(T);
    if (swap_) std::reverse(bytes.begin(), bytes.end());
    return std::bit_cast<T>(bytes);
  }

  std::optional<DicomTag> read_tag(std::uint64_t end) {
    const auto group = read_number<std::uint16_t>(end), element = read_number<std::uint16_t>(end);
    if (!group || !element) return {};
    return static_cast<DicomTag>(*group) << 16 | *element;
  }

  bool read_elements(std::uint64_t end, DicomItem& into, int depth, bool until_item_end) {
    while (position_ < end) {
      const auto tag = read_tag(end);
      if (!tag) return false;
      if (*tag == item_end && until_item_end) return read_number<std::uint32_t>(end).has_value();
      if (!read_element(*tag, end, into, depth)) return false;
    }
    return !until_item_end;
  }

  bool read_element(DicomTag tag, std::uint64_t end, DicomItem& into, int depth) {
    std::array<char, 2> vr{};
    std::optional<std::uint32_t> length;
    if (explicit_vr_) {
      if (end - position_ < 2 || !in_.read(vr.data(), 2)) return false;
      position_ += 2;
      const auto short_length = read_number<std::uint16_t>(end);
      if (!short_length) return false;
      constexpr std::string_view with_long_length = "OB OD OF OL OV OW SQ SV UC UN UR UT UV";
      const bool is_long = with_long_length.find(std::string_view(vr.data(), 2)) != std::string_view::npos;
      length = is_long ? read_number<std::uint32_t>(end) : std::optional<std::uint32_t>(*short_length);
    } else {
      length = read_number<std::uint32_t>(end);
    }
    if (!length) return false;
    const std::string_view type(vr.data(), 2);
    if (tag == pixel_data && depth == 0) return read_pixels(*length, end);
    if (type == "SQ" || *length == undefined_length || (!explicit_vr_ && is_known_sequence(tag)))
      return read_sequence(*length, end, into[tag], depth + 1, type == "UN");
    if (*length > end - position_) return false;
    if (type == "UN" && is_known_sequence(tag) && begins_item(*length)) {
      const std::uint64_t begin = position_;
      if (read_sequence(*length, end, into[tag], depth + 1, true)) return true;
      // Its items have types, against the standard.
      into.erase(tag);
      explicit_vr_ = true;
      position_ = begin;
      in_.clear();
      return skip(*length, end);
    }
    const std::uint32_t longest = is_palette(tag) ? 2 * longest_value : longest_value;
    if (*length > longest && tag != contour_data) return skip(*length, end);
    DicomElement& element = into[tag];
    element.value.resize(*length);
    position_ += *length;
    return *length == 0 || static_cast<bool>(in_.read(element.value.data(), *length));
  }

  /// Whether what follows is an item of a little-endian file: a program that does not know a sequence may have written
  /// it with the length that it has.
  bool begins_item(std::uint32_t length) {
    std::array<char, 4> start{};
    if (swap_ != (std::endian::native == std::endian::big) || length < 8 || !in_.read(start.data(), start.size()))
      return false;
    in_.seekg(static_cast<std::streamoff>(position_));
    return std::string_view(start.data(), start.size()) == std::string_view("\xfe\xff\x00\xe0", 4);
  }

  bool read_sequence(std::uint32_t length, std::uint64_t end, DicomElement& into, int depth, bool unknown) {
    if (depth > deepest) return false;
    if (length != undefined_length && length > end - position_) return false;
    const std::uint64_t last = length == undefined_length ? end : position_ + length;
    // Sequences of unknown type are written without type marks [PS3.5, §6.2.2].
    const bool explicit_before = std::exchange(explicit_vr_, explicit_vr_ && !unknown);
    while (position_ < last) {
      const auto tag = read_tag(last);
      const auto item_length = read_number<std::uint32_t>(last);
      if (!tag || !item_length) return false;
      if (*tag == sequence_end) break;
      if (*tag != item_tag) return false;
      const bool open = *item_length == undefined_length;
      if (!open && *item_length > last - position_) return false;
      if (!read_elements(open ? last : position_ + *item_length, into.items.emplace_back(), depth, open)) return false;
    }
    explicit_vr_ = explicit_before;
    return true;
  }

  bool read_pixels(std::uint32_t length, std::uint64_t end) {
    DicomPixels pixels;
    if (length != undefined_length) {
      pixels.block.offset = position_;
      pixels.bytes = length;
      set_.pixels = pixels;
      return skip(length, end);
    }
    for (bool offset_table = true;; offset_table = false) {
      const auto tag = read_tag(end);
      const auto fragment_length = read_number<std::uint32_t>(end);
      if (!tag || !fragment_length) return false;
      if (*tag == sequence_end) break;
      const std::uint64_t offset = position_;
      if (*tag != item_tag || !skip(*fragment_length, end)) return false;
      if (offset_table) continue;
      pixels.fragments.push_back({offset, *fragment_length});
      pixels.bytes += *fragment_length;
    }
    if (!pixels.fragments.empty()) set_.pixels = pixels;
    return true;
  }

  std::istream& in_;
  std::uint64_t position_ = 0, end_;
  DicomSet& set_;
  bool explicit_vr_ = true, swap_ = std::endian::native == std::endian::big;
};

/// Whether every line feed follows a carriage return, as none but chance would have it in a binary file: what a
/// transfer as text, or a version control that takes it for text, makes of one.
bool has_converted_line_ends(const fs::path& path) {
  constexpr std::uintmax_t enough = std::uintmax_t{1} << 22;
  std::ifstream in(path, std::ios::binary);
  bool any = false;
  char before = 0, c = 0;
  for (std::uintmax_t at = 0; at < enough && in.get(c); ++at) {
    if (c == '\n' && before != '\r') return false;
    any = any || c == '\n';
    before = c;
  }
  return any;
}

tl::unexpected<Error> cut_short_set(const fs::path& path) {
  if (has_converted_line_ends(path))
    return fail(path.string(),
                "is damaged: its line ends were converted, as a transfer as text does; copy it again as a binary file");
  return fail(path.string(), "is cut short or damaged: it ends within an element; copy or download it again");
}

tl::unexpected<Error> no_dicom(const fs::path& path) {
  return fail(path.string(), "is not a DICOM file, or its beginning is missing; check what it is and copy it again");
}

/// The deflated data set, inflated, since the structure can only be followed there.
Result<void> parse_deflated(std::uint64_t begin, DicomSet& set) {
  const ByteBlock block{.file = set.path, .offset = begin, .compression = Compression::RawDeflate};
  auto inflated = read_to_end(block, std::uintmax_t{1} << 30);
  if (!inflated) return fail(inflated.error());
  const std::uint64_t size = inflated->size();
  std::istringstream in(std::move(*inflated));
  Parser parser(in, size, set);
  if (!parser.read_data_set(true, false)) return cut_short_set(set.path);
  if (set.pixels) {
    set.pixels->block.skip = set.pixels->block.offset;
    set.pixels->block.offset = begin;
    set.pixels->block.compression = Compression::RawDeflate;
  }
  return {};
}

/// Whether bytes begin with an element of a low group: a data set without the usual preamble.
bool begins_as_data_set(const std::string_view start) {
  return start.size() >= 8 && (start[0] == 2 || start[0] == 8) && start[1] == 0 && start[3] == 0;
}

}  // namespace

bool looks_like_dicom(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return false;  // a pipe may never end
  std::ifstream in(path, std::ios::binary);
  if (!in) return false;
  char start[132] = {};
  in.read(start, sizeof start);
  const bool typed =
      std::isupper(static_cast<unsigned char>(start[4])) && std::isupper(static_cast<unsigned char>(start[5]));
  return std::string_view(start + 128, 4) == "DICM" || lower_case(path.extension().string()) == ".dcm" ||
         (typed && begins_as_data_set({start, sizeof start}));
}

Result<DicomSet> parse_dicom(const fs::path& path) {
  DicomSet set;
  set.path = path;
  const auto size = size_of_file(path);
  if (!size) return fail(size.error());
  std::ifstream in(path, std::ios::binary);
  std::array<char, 132> start{};
  in.read(start.data(), start.size());
  const auto got = static_cast<std::size_t>(in.gcount());
  in.clear();
  const bool marked = std::string_view(start.data() + 128, 4) == "DICM";
  if (!marked && !begins_as_data_set({start.data(), got})) return no_dicom(path);

  Parser parser(in, *size, set);
  parser.skip(marked ? start.size() : 0, *size);
  if (!marked) in.seekg(0);
  DicomItem meta;
  if (!parser.read_meta(meta)) return cut_short_set(path);
  set.transfer_syntax = text_of(meta, transfer_syntax_tag);
  if (set.transfer_syntax.empty() && marked)
    return fail(path.string(), "does not say how it is encoded (its transfer syntax is missing); export it again");
  if (!set.transfer_syntax.empty() && !is_known_syntax(set.transfer_syntax))
    return fail(path.string(), "is encoded in the transfer syntax " + excerpt(set.transfer_syntax) +
                                   (set.transfer_syntax == "1.2.840.113619.5.2" ? " (a private one of GE)" : "") +
                                   ", which cannot be read; export it uncompressed (Explicit VR Little Endian)");
  if (set.transfer_syntax == deflated_syntax) {
    if (auto parsed = parse_deflated(parser.position(), set); !parsed) return fail(parsed.error());
  } else {
    set.big_endian = set.transfer_syntax == big_endian_syntax;
    // Without the mark only the type of the first element tells; its letters are no plausible length.
    const bool typed = marked ? set.transfer_syntax != implicit_syntax : start[4] >= 'A' && start[5] >= 'A';
    if (!parser.read_data_set(typed, set.big_endian)) {
      if (!set.pixels && set.elements.empty() && !(marked && has_converted_line_ends(path))) return no_dicom(path);
      return cut_short_set(path);
    }
  }
  if (set.pixels) set.pixels->block.file = path;
  return set;
}

std::string text_of(const DicomItem& item, DicomTag tag) {
  const auto found = item.find(tag);
  if (found == item.end()) return {};
  std::string text = found->second.value;
  const auto padding = [](char c) { return c == ' ' || c == '\0'; };
  text.erase(std::find_if_not(text.rbegin(), text.rend(), padding).base(), text.end());
  text.erase(text.begin(), std::find_if_not(text.begin(), text.end(), padding));
  return text;
}

std::vector<double> numbers_of(const DicomItem& item, DicomTag tag) {
  std::vector<double> numbers;
  const std::string text = text_of(item, tag);
  for (const char *c = text.data(), *end = c + text.size(); c < end;) {
    while (c < end && (*c == ' ' || *c == '+')) ++c;
    double number = 0;
    const auto [rest, error] = std::from_chars(c, end, number);
    if (error != std::errc() || !std::isfinite(number)) return {};
    numbers.push_back(number);
    c = rest;
    while (c < end && *c == ' ') ++c;
    if (c < end && *c++ != '\\') return {};
  }
  return numbers;
}

std::optional<double> number_of(const DicomItem& item, DicomTag tag) {
  const auto numbers = numbers_of(item, tag);
  if (numbers.empty()) return {};
  return numbers.front();
}

std::optional<double> binary_number_of(const DicomItem& item, DicomTag tag, bool big_endian) {
  const auto found = item.find(tag);
  if (found == item.end()) return {};
  std::string bytes = found->second.value;
  if (big_endian != (std::endian::native == std::endian::big)) std::reverse(bytes.begin(), bytes.end());
  const auto as = [&bytes](auto number) {
    std::memcpy(&number, bytes.data(), sizeof number);
    return static_cast<double>(number);
  };
  switch (bytes.size()) {
    case 2:
      return as(std::uint16_t{});
    case 4:
      return as(std::uint32_t{});
    case 8:
      return as(double{});
    default:
      return {};
  }
}

const DicomItem* item_of(const DicomItem& item, DicomTag sequence, std::size_t index) {
  const auto found = item.find(sequence);
  if (found == item.end() || index >= found->second.items.size()) return nullptr;
  return &found->second.items[index];
}

const DicomItem* own_aspect(const DicomItem& data, std::size_t plane, DicomTag aspect) {
  const DicomItem* own = item_of(data, plane_groups, plane);
  return own != nullptr ? item_of(*own, aspect, 0) : nullptr;
}

const DicomItem& aspect_of(const DicomItem& data, std::size_t plane, DicomTag aspect) {
  if (const DicomItem* own = own_aspect(data, plane, aspect)) return *own;
  if (const DicomItem* shared = item_of(data, shared_groups, 0))
    if (const DicomItem* found = item_of(*shared, aspect, 0)) return *found;
  return data;
}

}  // namespace homolog
