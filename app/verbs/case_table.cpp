#include "app/verbs/case_table.h"

#include <algorithm>
#include <set>

#include "core/base/files/file_stem.h"
#include "core/base/text/text.h"
#include "core/base/text/text_table.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// What a column is called here: people write "mask" for the label map and "scan" for the image.
std::string column_named(const std::string& text) {
  static const std::map<std::string, std::string> others{
      {"mask", "labels"}, {"label_map", "labels"}, {"labelmap", "labels"}, {"segmentation", "labels"},
      {"scan", "image"},  {"volume", "image"},     {"mesh", "file"},       {"shape", "file"},
      {"case", "name"},   {"id", "name"}};
  const std::string small = lower_case(text);
  if (is_own_column(small)) return small;
  const auto other = others.find(small);
  return other == others.end() ? text : other->second;
}

}  // namespace

Result<std::vector<RowOfCase>> read_case_table(const fs::path& path) {
  auto table = read_text_table(path);
  if (!table) return fail(table.error());
  mend_encoding(*table);  // else names and groups would lose letters
  for (std::string& column : table->columns) column = column_named(column);
  const auto& columns = table->columns;
  if (std::set<std::string>(columns.begin(), columns.end()).size() != columns.size())
    return fail(path.string(), "has a column twice; rename one of them");
  if (auto mended = mend_decimal_commas(path, *table, is_own_column); !mended) return fail(mended.error());
  std::vector<RowOfCase> rows;
  for (auto& cells : table->rows) {
    RowOfCase row;
    for (std::size_t k = 0; k < cells.size(); ++k) row[columns[k]] = std::move(cells[k]);
    rows.push_back(std::move(row));
  }
  if (rows.empty())
    return fail(path.string(),
                "has no cases; give a line with the columns (name, image, labels, label, group, file) and one a case");
  return rows;
}

bool is_own_column(const std::string& column) {
  static constexpr std::array own{"name", "image", "labels", "label", "group", "file", "notes"};
  return std::find(own.begin(), own.end(), column) != own.end();
}

std::string cell_of(const RowOfCase& row, const char* column) {
  const auto cell = row.find(column);
  return cell == row.end() ? std::string() : cell->second;
}

std::string name_of_row(const RowOfCase& row) {
  if (std::string name = cell_of(row, "name"); !name.empty()) return name;
  for (const char* column : file_columns)
    if (const std::string file = cell_of(row, column); !file.empty()) return file_stem(file);
  return {};
}

bool is_case_table(const fs::path& file) {
  return lower_case(file.extension().string()) == ".csv";
}

std::vector<FileOfTable> files_of_table(const fs::path& table) {
  std::vector<FileOfTable> files;
  const auto rows = read_case_table(table);
  if (!rows) return files;  // whoever makes the study says why
  for (const RowOfCase& row : *rows)
    for (const char* column : file_columns)
      if (std::string file = cell_of(row, column); !file.empty()) files.push_back({name_of_row(row), std::move(file)});
  return files;
}

}  // namespace homolog
