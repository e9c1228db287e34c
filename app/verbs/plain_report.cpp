#include "app/verbs/plain_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/base/text/text.h"

namespace homolog {

namespace {

std::string plain_text(const Json& value) {
  if (value.is_string()) return printable(value.get<std::string>());
  if (value.is_number_float()) return plain_number(value.get<double>());
  if (value.is_null()) return "-";
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_array()) {
    std::string all;
    for (const Json& one : value) all += (all.empty() ? "" : ", ") + plain_text(one);
    return all;
  }
  return printable(value.dump(-1, ' ', false, Json::error_handler_t::replace));
}

/// Rows whose "values" by name are columns of their own.
Json with_values_as_columns(const Json& rows) {
  Json all = Json::array();
  for (const Json& row : rows) {
    Json flat = Json::object();
    for (const auto& [key, value] : row.items())
      if (key == "values" && value.is_object())
        flat.update(value);
      else
        flat[key] = value;
    all.push_back(std::move(flat));
  }
  return all;
}

/// A table for a list of objects.
class Table {
 public:
  explicit Table(const Json& given) {
    const Json rows = with_values_as_columns(given);
    for (const Json& row : rows)
      for (const auto& [key, value] : row.items())
        if (cell_of(value) && std::find(columns_.begin(), columns_.end(), key) == columns_.end())
          columns_.push_back(key);
    std::vector<std::string> head;
    for (const std::string& column : columns_) head.push_back(printable(column));
    lines_.push_back(std::move(head));
    for (const Json& row : rows) {
      std::vector<std::string> line;
      for (const std::string& column : columns_) {
        const auto found = row.find(column);
        line.push_back(found == row.end() ? "" : cell_of(*found).value_or(""));
        is_number_.resize(columns_.size(), true);
        if (found != row.end() && !found->is_number() && !found->is_object() && !found->is_null())
          is_number_[line.size() - 1] = false;
      }
      lines_.push_back(std::move(line));
    }
  }

  void print(const std::string& indent, std::ostream& out) const {
    std::vector<std::size_t> widths(columns_.size());
    for (const auto& line : lines_)
      for (std::size_t k = 0; k < line.size(); ++k) widths[k] = std::max(widths[k], width_of(line[k]));
    for (const auto& line : lines_) {
      std::string text = indent;
      for (std::size_t k = 0; k < line.size(); ++k) {
        const std::string pad(widths[k] - width_of(line[k]), ' ');
        text += is_number_[k] ? pad + line[k] : line[k] + pad;
        text += "  ";
      }
      out << text.substr(0, text.find_last_not_of(' ') + 1) << '\n';
    }
  }

 private:
  /// Of one letter each, as good as is needed: bytes that do not go on.
  static std::size_t width_of(const std::string& text) {
    return static_cast<std::size_t>(
        std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
  }
  static std::optional<std::string> cell_of(const Json& value) {
    if (value.is_array()) return std::nullopt;
    if (!value.is_object()) return plain_text(value);
    const auto mean = value.find("mean");
    return mean == value.end() || mean->is_structured() ? std::nullopt : std::optional(plain_text(*mean));
  }

  std::vector<std::string> columns_;
  std::vector<bool> is_number_;
  std::vector<std::vector<std::string>> lines_;
};

bool is_list_of_objects(const Json& value) {
  return value.is_array() && !value.empty() &&
         std::all_of(value.begin(), value.end(), [](const Json& one) { return one.is_object(); });
}

/// The lists of objects within the rows of a list: of each name all rows together, with a first column that says whose
/// they are. `of`: what the list is called, as "cases".
std::vector<std::pair<std::string, Json>> lists_within(const std::string& of, const Json& rows) {
  const std::string whose = of.ends_with('s') ? of.substr(0, of.size() - 1) : of;
  std::vector<std::pair<std::string, Json>> lists;
  for (const Json& row : rows) {
    const auto name = std::find_if(row.begin(), row.end(), [](const Json& one) { return one.is_string(); });
    if (name == row.end()) continue;
    for (const auto& [key, value] : row.items()) {
      if (!is_list_of_objects(value)) continue;
      const auto is_it = [&key = key](const auto& one) { return one.first == key; };
      auto list = std::find_if(lists.begin(), lists.end(), is_it);
      if (list == lists.end()) list = lists.insert(lists.end(), {key, Json::array()});
      for (const Json& one : value) {
        Json line{{whose, *name}};
        line.update(one);
        list->second.push_back(std::move(line));
      }
    }
  }
  return lists;
}

void print_values(const Json& values, const std::string& indent, std::ostream& out) {
  for (const auto& [key, value] : values.items()) {
    if (value.is_object()) {
      out << indent << printable(key) << ":\n";
      print_values(value, indent + "  ", out);
    } else if (is_list_of_objects(value)) {
      out << indent << printable(key) << ":\n";
      Table(value).print(indent + "  ", out);
      for (const auto& [name, rows] : lists_within(key, value)) {
        out << indent << printable(name) << ":\n";
        Table(rows).print(indent + "  ", out);
      }
    } else {
      out << indent << printable(key) << ": " << plain_text(value) << '\n';
    }
  }
}

}  // namespace

std::string plain_number(double value) {
  if (!std::isfinite(value)) return "-";
  const double size = std::abs(value);
  const int before = size >= 1 ? static_cast<int>(std::floor(std::log10(size))) + 1 : 0;
  int decimals = std::max(0, 4 - before);
  for (double least = 0.1; before == 0 && size < least && decimals < 6; least /= 10) ++decimals;
  char text[400];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  std::string plain = text;
  if (plain.find('.') != std::string::npos) {
    plain.erase(plain.find_last_not_of('0') + 1);
    if (plain.ends_with('.')) plain.pop_back();
  }
  return plain == "-0" ? "0" : plain;
}

void print_report(const Json& values, std::ostream& out) {
  print_values(values, "", out);
}

}  // namespace homolog
