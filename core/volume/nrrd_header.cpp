#include "core/volume/nrrd_header.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <optional>
#include <string_view>

#include "core/base/files/files.h"
#include "core/base/text/text.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t longest_header = std::size_t{16} << 20;
// Longest line for NrrdIO, which writes what it dislikes into buffers of fixed size. Three directions in space, the
// longest field, take 240 characters.
constexpr std::size_t longest_field = 500;
constexpr std::int64_t most_files = 1000000;

tl::unexpected<Error> no_header(const fs::path& path) {
  return fail(path.string(), "is not an NRRD file, or its header is damaged; check what it is and export it again");
}

tl::unexpected<Error> bad_names(const fs::path& path, const std::string& value) {
  return fail(path.string(), "names its voxels' files in a way that cannot be followed (data file: " +
                                 value.substr(0, 60) + "); write it as slice%03d.raw MIN MAX STEP, or as a list");
}

/// The value of a line "FIELD: VALUE"; nothing where the line is another. Case and blanks in the field's name do not
/// matter, so that no spelling that the library knows is missed; `field` is in lower case and without blanks.
std::optional<std::string> field_value(const std::string& line, std::string_view field) {
  const auto colon = line.find(':');
  if (colon == std::string::npos || line.substr(colon).starts_with(":=")) return {};
  std::string name = lower_case(line.substr(0, colon));
  std::erase_if(name, [](char c) { return c == ' ' || c == '\t'; });
  if (name != field) return {};
  const auto begin = line.find_first_not_of(" \t", colon + 1);
  if (begin == std::string::npos) return std::string();
  return line.substr(begin, line.find_last_not_of(" \t") + 1 - begin);
}

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::size_t begin = 0; (begin = text.find_first_not_of(" \t", begin)) != std::string_view::npos;) {
    const auto end = std::min(text.find_first_of(" \t", begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = end;
  }
  return words;
}

bool is_number(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return false;
  text = text.substr(begin, text.find_last_not_of(" \t") + 1 - begin);
  if (text.starts_with('+')) text.remove_prefix(1);
  return as_number<double>(text).has_value();
}

/// Whether each "(x,y,z)" of a text holds numbers with commas between them, and nothing else.
bool holds_vectors(std::string_view text) {
  for (std::size_t begin = 0; (begin = text.find('(', begin)) != std::string_view::npos;) {
    const auto end = text.find(')', begin);
    if (end == std::string_view::npos) return false;
    for (std::size_t from = begin + 1; from <= end;) {
      const auto to = std::min(text.find(',', from), end);
      if (!is_number(text.substr(from, to - from))) return false;
      from = to + 1;
    }
    begin = end;
  }
  return true;
}

/// Whether text is a whole number above 0, however large.
bool is_count(std::string_view text) {
  return text.find_first_not_of("0123456789") == std::string_view::npos &&
         text.find_first_not_of('0') != std::string_view::npos;
}

/// A file name with a number in it: what stands before and behind, and how the number is written.
struct NameFormat {
  std::string before, behind;
  bool zeros = false;
  int width = 0;

  std::string name(int number) const {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), zeros ? "%0*d" : "%*d", width, number);
    return before + text.data() + behind;
  }
};

/// "slice%03d.raw", and nothing that is more than that.
std::optional<NameFormat> name_format(std::string_view text) {
  const auto percent = text.find('%');
  NameFormat format;
  format.before = text.substr(0, percent);
  std::string_view rest = text.substr(percent + 1);
  format.zeros = rest.starts_with('0');
  if (format.zeros) rest.remove_prefix(1);
  const auto digits = std::min(rest.find_first_not_of("0123456789"), rest.size());
  if (digits > 2 || rest.substr(digits, 1) != "d") return {};
  if (digits > 0) format.width = *as_number<int>(rest.substr(0, digits));
  format.behind = rest.substr(digits + 1);
  if (format.behind.find('%') != std::string::npos) return {};
  return format;
}

/// Files by a format: "slice%03d.raw MIN MAX STEP [AXES]".
Result<void> add_numbered_files(const fs::path& path, const std::string& value, NrrdHeader& header) {
  const auto words = words_of(value);
  if (words.size() != 4 && words.size() != 5) return bad_names(path, value);
  const auto format = name_format(words[0]);
  const auto first = as_number<int>(words[1]), last = as_number<int>(words[2]), step = as_number<int>(words[3]);
  const auto axes = words.size() == 5 ? as_number<int>(words[4]) : std::optional<int>(0);
  if (!format || !first || !last || !step || *step == 0 || !axes || *axes < 0) return bad_names(path, value);
  const std::int64_t apart = std::int64_t{*last} - *first;
  if (apart / *step < 0 || (apart != 0 && (apart < 0) != (*step < 0)) || apart / *step >= most_files)
    return bad_names(path, value);
  for (std::int64_t i = 0; i <= apart / *step; ++i)
    header.files.push_back(path.parent_path() / format->name(static_cast<int>(*first + i * *step)));
  header.file_dimension = *axes;
  return {};
}

/// Comments, pairs KEY:=VALUE and descriptions, of any length; nothing of them is needed.
bool is_remark(const std::string& line) {
  const auto colon = line.find(':');
  return line.starts_with('#') || (colon != std::string::npos && line.substr(colon).starts_with(":=")) ||
         field_value(line, "content");
}

/// The words of a list in which each is quoted, as the format has it, or none, as others write it: with commas or
/// brackets between them.
std::vector<std::string> quoted_words(std::string_view text) {
  constexpr std::string_view between = " \t,[]()";
  std::vector<std::string> words;
  while (true) {
    text.remove_prefix(std::min(text.find_first_not_of(between), text.size()));
    if (text.empty()) return words;
    const bool quoted = text[0] == '"' || text[0] == '\'';
    const auto end = std::min(quoted ? text.find(text[0], 1) : text.find_first_of(between), text.size());
    std::string word(text.substr(quoted ? 1 : 0, quoted ? end - 1 : end));
    word.erase(0, std::min(word.find_first_not_of(" \t"), word.size()));
    word.erase(word.find_last_not_of(" \t") + 1);
    words.push_back(std::move(word));
    text.remove_prefix(std::min(end + (quoted ? 1 : 0), text.size()));
  }
}

/// Takes what a line says of units or of what a list of values is. Whether the library need not see the line.
bool take_over(const std::string& line, NrrdHeader& header) {
  if (const auto units = field_value(line, "spaceunits")) {
    header.space_units = quoted_words(*units);
    return true;
  }
  if (const auto units = field_value(line, "units")) {
    header.units = quoted_words(*units);
    return true;
  }
  const std::string_view segment = "Segment";
  if (const auto pair = line.find(":="); pair != std::string::npos && line.starts_with(segment)) {
    const std::string_view key = std::string_view(line).substr(segment.size(), pair - segment.size());
    const bool of_one = !key.empty() && key[0] >= '0' && key[0] <= '9' && key.find('_') != key.npos;
    header.is_segmentation = header.is_segmentation || of_one || key.starts_with("ation_");
    if (of_one) header.segment_pairs.emplace_back(line.substr(0, pair), line.substr(pair + 2));
  }
  header.is_diffusion = header.is_diffusion || line.starts_with("modality:=DWMRI");
  return false;
}

/// Goes through the lines of a header.
class Lines {
 public:
  explicit Lines(const std::string& text) : text_(text) {}
  /// The next line without its end; nothing at the end of the text.
  std::optional<std::string> next() {
    if (begin_ >= text_.size()) return {};
    const auto end = std::min(text_.find('\n', begin_), text_.size());
    std::string line = text_.substr(begin_, end - begin_);
    begin_ = std::min(end + 1, text_.size());
    if (line.ends_with('\r')) line.pop_back();
    return line;
  }
  std::size_t position() const { return begin_; }

 private:
  const std::string& text_;
  std::size_t begin_ = 0;
};

/// The names follow, one a line, up to the end of the header.
bool is_list(std::string_view value) {
  const auto words = words_of(value);
  return !words.empty() && words[0] == "LIST";
}

Result<void> add_data_files(const fs::path& path, const std::string& value, Lines& lines, NrrdHeader& header) {
  if (header.detached) return bad_names(path, value);  // a second time
  header.detached = true;
  if (is_list(value)) {
    const auto words = words_of(value);
    const auto axes = words.size() == 2 ? as_number<int>(words[1]) : std::optional<int>(0);
    if (words.size() > 2 || !axes || *axes < 0) return bad_names(path, value);
    header.file_dimension = *axes;
    for (auto name = lines.next(); name && !name->empty(); name = lines.next())
      header.files.push_back(path.parent_path() / *name);
  } else if (value.find('%') != std::string::npos) {
    return add_numbered_files(path, value, header);
  } else {
    header.files.push_back(path.parent_path() / value);
  }
  if (header.files.empty() || value.empty() || value == "-") return bad_names(path, value);
  return {};
}

/// The file up to the empty line that ends the header, and a little more: the voxels that follow may be gigabytes.
Result<std::string> header_text(const fs::path& path) {
  if (const auto size = size_of_file(path); !size) return fail(size.error());
  std::ifstream in(path, std::ios::binary);
  std::string text;
  std::array<char, 4096> piece;
  for (std::size_t seen = 0; text.size() < longest_header && in;) {
    in.read(piece.data(), piece.size());
    text.append(piece.data(), static_cast<std::size_t>(in.gcount()));
    if (text.find("\n\n", seen) != std::string::npos || text.find("\n\r\n", seen) != std::string::npos) break;
    seen = text.size() - std::min<std::size_t>(text.size(), 2);
  }
  return text;
}

}  // namespace

Result<NrrdHeader> read_nrrd_header(const fs::path& path) {
  auto text = header_text(path);
  if (!text) return fail(text.error());
  NrrdHeader header;
  const std::string name = lower_case(path.filename().string());
  header.is_segmentation = name.ends_with(".seg.nrrd") || name.ends_with(".seg.nhdr");
  Lines lines(*text);
  bool ended = false, sized = false, dimensioned = false;
  while (!ended) {
    const auto line = lines.next();
    if (!line) break;
    if (line->find('\0') != std::string::npos) return no_header(path);  // the library would stop reading there
    if (const auto value = field_value(*line, "datafile")) {
      if (auto added = add_data_files(path, *value, lines, header); !added) return fail(added.error());
      ended = is_list(*value);
      continue;
    }
    if (const auto sizes = field_value(*line, "sizes")) {  // the library reads 1.5 as 1
      for (const std::string_view size : words_of(*sizes))
        if (!is_count(size)) return fail(path.string(), "has sizes that are no whole numbers above 0; export it again");
      sized = true;
    }
    dimensioned = dimensioned || field_value(*line, "dimension");
    ended = line->empty();
    const bool taken = take_over(*line, header);
    if (is_remark(*line)) continue;
    if (line->size() > longest_field)
      return fail(path.string(), "has a header line of " + std::to_string(line->size()) +
                                     " characters, which no field of NRRD needs; export it again");
    // The library reads "1.5x" as 1.5, and of "1 5" the 1.
    for (const char* field : {"space origin", "space directions", "measurement frame"}) {
      std::string key = field;
      std::erase(key, ' ');
      if (const auto value = field_value(*line, key); value && !holds_vectors(*value))
        return fail(path.string(), "has a " + std::string(field) + " that is no numbers with commas between them (" +
                                       excerpt(*value) + "); export it again");
    }
    for (const char* field : {"dimension", "spacings", "axis mins", "axis maxs", "line skip", "byte skip"}) {
      std::string key = field;
      std::erase(key, ' ');
      if (const auto value = field_value(*line, key); value && !std::ranges::all_of(words_of(*value), is_number))
        return fail(path.string(), "gives as its " + std::string(field) + " what is no number (" + excerpt(*value) +
                                       "); export it again");
    }
    if (!taken) header.fields += *line + "\n";
  }
  const bool whole = ended || (header.detached && text->size() < longest_header);
  if (!whole || !text->starts_with("NRRD")) return no_header(path);
  if (!sized || !dimensioned)  // the library, which would say so, loses memory over it
    return fail(path.string(), std::string("cannot be read as NRRD (it lacks the field ") +
                                   (dimensioned ? "sizes" : "dimension") + "); check the file or export it again");
  header.voxels_begin = lines.position();
  return header;
}

}  // namespace homolog
