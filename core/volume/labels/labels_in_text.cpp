#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include "core/base/pictures/colour.h"
#include "core/base/text/text.h"
#include "core/volume/labels/label_tables.h"
#include "core/volume/labels/named_labels.h"

namespace homolog {

namespace {

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
  if (as_number<double>(trimmed(label.name))) return {};
  return label;
}

/// The columns of a table; the first of these names that it has.
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

}  // namespace

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
    if (!columns) separator = table_separator(line);
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

}  // namespace homolog
