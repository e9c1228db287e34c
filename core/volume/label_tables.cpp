#include "core/volume/label_tables.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/colour.h"
#include "core/base/file_stem.h"
#include "core/base/files.h"
#include "core/base/json.h"
#include "core/base/text.h"
#include "core/volume/label_likeness.h"

namespace homolog {
namespace fs = std::filesystem;

namespace {

using LabelColour = std::array<std::uint8_t, 3>;

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\n";
  const auto begin = text.find_first_not_of(blanks);
  return begin == text.npos ? std::string_view() : text.substr(begin, text.find_last_not_of(blanks) + 1 - begin);
}

/// All of the text as a number.
template <class T>
std::optional<T> number_in(std::string_view text) {
  text = trimmed(text);
  T number = 0;
  const auto [after, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || after != text.data() + text.size()) return {};
  return number;
}

std::optional<int> label_in(std::string_view text) {
  const auto value = number_in<int>(text);
  return value && *value >= 0 ? value : std::nullopt;
}

/// Adds a label's name; 0 is the background. Errors: another name is known of it.
Result<void> add_name(int value, std::string_view text, std::optional<LabelColour> colour, Segmentation& labels) {
  const std::string name = segment_name(text);
  if (value <= 0 || name.empty()) return {};
  const Segment* known = labels.find(value, 0);
  if (known != nullptr && known->name != name)
    return fail("", "gives label " + std::to_string(value) + " two names (" + excerpt(known->name) + " and " +
                        excerpt(name) + ")");
  labels.add({.name = name, .value = value, .layer = 0, .colour = colour});
  return {};
}

/// Red, green and blue as numbers of 0 to 255, or where all are at most 1 and one has a point as shares.
std::optional<LabelColour> colour_in(std::span<const std::string_view> channels) {
  std::array<double, 3> numbers{};
  bool shares = true, point = false;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto number = number_in<double>(channels[c]);
    if (!number || !(*number >= 0 && *number <= 255)) return {};
    numbers[c] = *number;
    shares = shares && *number <= 1;
    point = point || channels[c].find('.') != std::string_view::npos;
  }
  LabelColour colour{};
  for (std::size_t c = 0; c < 3; ++c)
    colour[c] = static_cast<std::uint8_t>(std::lround(shares && point ? 255 * numbers[c] : numbers[c]));
  return colour;
}

using Json = nlohmann::json;

std::optional<int> label_in_json(const Json& value) {
  if (value.is_string()) return label_in(value.get<std::string>());
  if (!value.is_number()) return {};
  const double number = value.get<double>();
  if (!(number >= 0 && number <= 1e9) || number != std::floor(number)) return {};
  return static_cast<int>(number);
}

const Json* member_of(const Json& object, std::span<const char* const> names) {
  for (const char* name : names)
    if (const auto found = object.find(name); found != object.end()) return &*found;
  return nullptr;
}

/// A list of objects, one a label.
Result<Segmentation> labels_of_list(const Json& list) {
  static constexpr std::array values{"value", "label", "labelValue", "id", "index"};
  static constexpr std::array names{"name", "structure"}, colours{"colour", "color"};
  Segmentation labels;
  for (const Json& one : list) {
    const Json* value = one.is_object() ? member_of(one, values) : nullptr;
    const Json* name = value ? member_of(one, names) : nullptr;
    if (!name || !label_in_json(*value)) return Segmentation();
    if (!name->is_string()) continue;  // null: it has none
    const Json* colour = member_of(one, colours);
    const bool hex = colour != nullptr && colour->is_string();
    if (auto added = add_name(*label_in_json(*value), name->get<std::string>(),
                              hex ? colour_from_hex(lower_case(colour->get<std::string>())) : std::nullopt, labels);
        !added)
      return fail(added.error());
  }
  return labels;
}

/// Of members all of which are value and name; `lists`: values may be lists of values (nnU-Net's regions), which name
/// no label.
Result<Segmentation> labels_of_members(const Json& object, bool lists) {
  Segmentation labels;
  for (const auto& [key, value] : object.items()) {
    const auto value_first = label_in(std::string_view(key));
    const auto value_last = value.is_number() ? label_in_json(value) : std::nullopt;
    if (lists && value.is_array()) continue;
    if (!(value_first && value.is_string()) && !value_last) return Segmentation();
    auto added = value_last ? add_name(*value_last, key, {}, labels)
                            : add_name(*value_first, value.get<std::string>(), {}, labels);
    if (!added) return fail(added.error());
  }
  return labels;
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    lines.push_back(trimmed(text.substr(0, end)));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

std::vector<std::string_view> words_in(std::string_view text) {
  std::vector<std::string_view> words;
  while (!(text = trimmed(text)).empty()) {
    const auto end = std::min(text.find_first_of(" \t"), text.size());
    words.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
  return words;
}

/// One label as a line of another program's table.
struct LabelLine {
  int value = 0;
  std::string_view name;
  std::optional<LabelColour> colour{};
};

std::optional<LabelLine> label_line(std::string_view line) {
  const auto words = words_in(line);
  if (words.size() < 2 || !label_in(words[0])) return {};
  LabelLine label{.value = *label_in(words[0]), .name = {}};
  if (const auto quote = line.find('"'); quote != line.npos) {  // ITK-SNAP
    label.name = line.substr(quote + 1, line.rfind('"') - quote - 1);
    if (words.size() > 4) label.colour = colour_in(std::span(words).subspan(1, 3));
    if (line.rfind('"') == quote || !label.colour) return {};
    return label;
  }
  constexpr std::size_t colour_words = 4;
  std::size_t behind = 0;
  if (words.size() >= 2 + colour_words) label.colour = colour_in(std::span(words).last(colour_words).first(3));
  if (label.colour) behind = colour_words;
  const auto& last = words[words.size() - behind - 1];
  label.name = line.substr(static_cast<std::size_t>(words[1].data() - line.data()),
                           static_cast<std::size_t>(last.data() + last.size() - words[1].data()));
  if (number_in<double>(label.name)) return {};
  return label;
}

std::vector<std::string> table_cells(std::string_view line, char separator) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"')
      quoted = !quoted;
    else if (c == separator && !quoted)
      cells.emplace_back();
    else
      cells.back() += c;
  }
  for (std::string& cell : cells) cell = std::string(trimmed(cell));
  return cells;
}

/// Where the columns of a table are; the first of these names that it has.
struct TableColumns {
  std::optional<std::size_t> value, name, colour;
  std::array<std::optional<std::size_t>, 3> channels;
  bool named = false;  ///< by the first line
};

std::string column_key(std::string_view cell) {
  std::string key = lower_case(std::string(cell));
  std::erase_if(key, [](char c) { return c == '_' || c == ' ' || c == '-'; });
  return key;
}

TableColumns columns_of(const std::vector<std::string>& first) {
  std::map<std::string, std::size_t> at;
  for (std::size_t c = 0; c < first.size(); ++c) at.try_emplace(column_key(first[c]), c);
  const auto find = [&](std::initializer_list<const char*> names) -> std::optional<std::size_t> {
    for (const char* name : names)
      if (const auto found = at.find(name); found != at.end()) return found->second;
    return {};
  };
  TableColumns columns;
  columns.value = find({"value", "labelvalue", "index", "id", "labelid", "number", "label"});
  columns.name = find({"name", "labelname", "structure", "segment"});
  if (!columns.name && columns.value && columns.value != find({"label"})) columns.name = find({"label"});
  columns.colour = find({"colour", "color", "hex"});
  columns.channels = {find({"red", "r", "colorr", "colourr"}), find({"green", "g", "colorg", "colourg"}),
                      find({"blue", "b", "colorb", "colourb"})};
  columns.named = columns.value && columns.name;
  if (columns.named || first.size() != 2) return columns;
  if (label_in(first[0]))
    columns = {.value = 0, .name = 1, .colour = {}, .channels = {}};
  else if (label_in(first[1]))
    columns = {.value = 1, .name = 0, .colour = {}, .channels = {}};
  return columns;
}

std::optional<LabelColour> colour_of_row(const TableColumns& columns, const std::vector<std::string>& cells) {
  if (columns.colour) return colour_from_hex(lower_case(cells[*columns.colour]));
  const auto& [red, green, blue] = columns.channels;
  if (!red || !green || !blue) return {};
  const std::array<std::string_view, 3> channels{cells[*red], cells[*green], cells[*blue]};
  return colour_in(channels);
}

std::string about_line(std::size_t number, const std::string& what) {
  return "line " + std::to_string(number) + " " + what;
}

/// What an attribute of an XML element says, without entities.
std::optional<std::string_view> attribute(std::string_view element, std::string_view name) {
  for (std::size_t at = 0; (at = element.find(name, at)) != element.npos; at += name.size()) {
    const std::string_view rest = element.substr(at + name.size());
    const bool begins = at > 0 && (element[at - 1] == ' ' || element[at - 1] == '\t' || element[at - 1] == '\n');
    if (!begins || rest.size() < 2 || rest[0] != '=' || (rest[1] != '"' && rest[1] != '\'')) continue;
    const auto end = rest.find(rest[1], 2);
    return end == rest.npos ? std::nullopt : std::optional(rest.substr(2, end - 2));
  }
  return {};
}

std::string without_entities(std::string_view text) {
  static constexpr std::array<std::pair<std::string_view, char>, 5> entities{
      {{"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}, {"&amp;", '&'}}};
  std::string plain;
  while (!text.empty()) {
    const auto* entity = std::find_if(entities.begin(), entities.end(),
                                      [&](const auto& known) { return text.starts_with(known.first); });
    plain += entity == entities.end() ? text.front() : entity->second;
    text.remove_prefix(entity == entities.end() ? 1 : entity->first.size());
  }
  return plain;
}

/// The text of an element, which may be given as CDATA.
std::string element_text(std::string_view text) {
  text = trimmed(text);
  constexpr std::string_view begin = "<![CDATA[";
  if (!text.starts_with(begin)) return without_entities(text);
  return std::string(text.substr(begin.size(), text.find("]]>") - begin.size()));
}

/// Whether names from a file beside the volume are about it: it holds labels, or all that it holds has a name.
bool are_labels(const Volume& volume, const Segmentation& names) {
  if (volume.range_min < 0 || volume.range_max > 65535) return false;
  if (holds_labels(volume)) return true;
  const auto held = labels_of(volume);
  return std::all_of(held.begin(), held.end(), [&](const auto& label) { return names.find(label.first, 0); });
}

Result<Segmentation> names_in_file(const fs::path& file) {
  constexpr std::uintmax_t most_bytes = std::uintmax_t{16} << 20;
  auto text = read_whole_file(file, most_bytes);
  if (!text) return fail(text.error());
  if (text->starts_with("\xEF\xBB\xBF")) text->erase(0, 3);
  const std::string ending = lower_case(file.extension().string());
  return ending == ".json"                      ? labels_of_json(*text)
         : ending == ".csv" || ending == ".tsv" ? labels_of_table(*text)
                                                : labels_of_lines(*text);
}

std::vector<fs::path> files_beside(const fs::path& path) {
  const fs::path folder = path.parent_path();
  const std::string stem = file_stem(path);
  std::vector<fs::path> files{folder / (path.filename().string() + ".json")};
  static constexpr std::array endings{".json", ".csv", ".tsv", ".label", ".txt", ".ctbl"};
  for (const char* ending : endings) files.push_back(folder / (stem + ending));
  for (const char* name : {"labels", "label_map", "class_map"})
    for (const char* ending : endings) files.push_back(folder / (std::string(name) + ending));
  for (const char* name : {"dataset.json", "FreeSurferColorLUT.txt"}) files.push_back(folder / name);
  if (folder.filename().string().starts_with("labels")) files.push_back(folder.parent_path() / "dataset.json");
  return files;
}

}  // namespace

Result<Segmentation> labels_of_json(std::string_view text) {
  const auto json = read_json<Json>(text);
  if (!json) return fail("", "is no JSON (" + json.error().what + ")");
  if (json->is_array()) return labels_of_list(*json);
  if (!json->is_object()) return Segmentation();
  const auto labels = json->find("labels");
  if (labels == json->end()) return labels_of_members(*json, false);
  if (labels->is_array()) return labels_of_list(*labels);
  return labels->is_object() ? labels_of_members(*labels, true) : Segmentation();
}

Result<Segmentation> labels_of_lines(std::string_view text) {
  Segmentation labels;
  std::size_t number = 0, wrong = 0, named = 0;
  for (const std::string_view line : lines_of(text)) {
    ++number;
    if (line.empty() || line.starts_with('#')) continue;
    const auto label = label_line(line);
    if (!label && wrong == 0) wrong = number;
    if (!label) continue;
    ++named;
    if (auto added = add_name(label->value, label->name, label->colour, labels); !added)
      return fail("", about_line(number, added.error().what));
  }
  if (named > 0 && wrong > 0) return fail("", about_line(wrong, "has no number and name of a label"));
  return labels;
}

Result<Segmentation> labels_of_table(std::string_view text) {
  Segmentation labels;
  std::optional<TableColumns> columns;
  std::size_t number = 0, width = 0;
  char separator = ',';
  for (const std::string_view line : lines_of(text)) {
    ++number;
    if (line.empty() || line.starts_with('#')) continue;
    if (!columns) {
      for (const char one : {';', '\t'})
        if (line.find(',') == line.npos && line.find(one) != line.npos) separator = one;
    }
    const auto cells = table_cells(line, separator);
    if (!columns) {
      columns = columns_of(cells);
      width = cells.size();
      if (!columns->value || !columns->name) return Segmentation();  // about something else
      if (columns->named) continue;
    }
    const bool whole = cells.size() == width;
    const auto value = whole ? label_in(cells[*columns->value]) : std::nullopt;
    if (!value) return fail("", about_line(number, "has no number and name of a label"));
    if (auto added = add_name(*value, cells[*columns->name], colour_of_row(*columns, cells), labels); !added)
      return fail("", about_line(number, added.error().what));
  }
  return labels;
}

Segmentation labels_of_xml(std::string_view text) {
  Segmentation labels;
  constexpr std::string_view begin = "<Label", end = "</Label>";
  for (std::size_t at = 0; (at = text.find(begin, at)) != text.npos;) {
    at += begin.size();
    if (at >= text.size() || (text[at] != ' ' && text[at] != '\t' && text[at] != '\n')) continue;  // <LabelTable>
    const auto close = text.find('>', at);
    if (close == text.npos) break;
    const std::string_view element = text.substr(at - 1, close - at + 1);
    const auto behind = text.find(end, close);
    if (behind == text.npos) break;
    const auto key = attribute(element, "Key");
    const std::array channels{attribute(element, "Red"), attribute(element, "Green"), attribute(element, "Blue")};
    std::optional<LabelColour> colour;
    LabelColour shares{};
    bool coloured = true;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto share = channels[c] ? number_in<double>(*channels[c]) : std::nullopt;
      coloured = coloured && share && *share >= 0 && *share <= 1;
      if (coloured) shares[c] = static_cast<std::uint8_t>(std::lround(255 * *share));
    }
    if (coloured) colour = shares;
    if (const auto value = key ? label_in(*key) : std::nullopt)
      std::ignore = add_name(*value, element_text(text.substr(close + 1, behind - close - 1)), colour, labels);
    at = behind;
  }
  return labels;
}

void take_names_beside(const fs::path& path, VolumeRead& read) {
  if (!read.segmentation.segments.empty()) return;
  for (const fs::path& file : files_beside(path)) {
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) continue;
    const auto names = names_in_file(file);
    if (names && names->segments.empty()) continue;  // about something else
    if (!are_labels(read.volume, names ? *names : Segmentation())) return;
    if (names)
      read.segmentation = *names;
    else
      read.warnings.push_back(file.string() + ": " + names.error().what +
                              ", so that its names are not used; correct it, or move it away");
    return;
  }
}

}  // namespace homolog
