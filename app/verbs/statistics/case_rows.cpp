#include "app/verbs/statistics/case_rows.h"

#include <algorithm>
#include <filesystem>

#include "core/base/files/file_stem.h"
#include "core/base/text/listed.h"
#include "core/model/files/model_files.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// Where a row or a shape says that it lies.
struct NamedPlace {
  std::vector<std::string> folders;  ///< the outermost first
  std::string file, stem;
};

NamedPlace named_place_of(const fs::path& path) {
  NamedPlace place;
  for (const fs::path& part : path.lexically_normal())
    if (const std::string text = part.string(); !text.empty() && text != "." && text != ".." && text != "/")
      place.folders.push_back(text);
  if (place.folders.empty()) return place;
  place.file = place.folders.back();
  place.folders.pop_back();
  place.stem = file_stem(place.file);
  return place;
}

NamedPlace place_of_shape(const std::string& name, bool is_file) {
  std::error_code ignored;
  NamedPlace place = named_place_of(is_file ? fs::absolute(name, ignored) : fs::path(name));
  place.stem = is_file ? shape_stem(name) : place.file;
  return place;
}

/// A row that may be a shape's.
struct RowOfShape {
  std::size_t row = 0;
  std::size_t folders = 0;  ///< so many of the innermost are the same
  bool whole = false;       ///< all that both name are the same
  std::size_t likeness = 0;
};

RowOfShape compared(std::size_t number, const NamedPlace& row, const NamedPlace& shape) {
  RowOfShape one{number};
  const std::size_t both = std::min(row.folders.size(), shape.folders.size());
  while (one.folders < both &&
         row.folders[row.folders.size() - 1 - one.folders] == shape.folders[shape.folders.size() - 1 - one.folders])
    ++one.folders;
  one.whole = one.folders == both;
  // Of rows in the same folder the very name goes before one with an ending.
  one.likeness = 3 * one.folders + (row.file == shape.stem ? 2 : row.file == shape.file ? 1 : 0);
  return one;
}

/// Brings rows and shapes together.
class RowsOfShapes {
 public:
  RowsOfShapes(const CovariateTable& table, const std::vector<ShapeOfRow>& shapes, bool are_files)
      : table_(table), shapes_(shapes), are_files_(are_files), found_(shapes.size()), may_be_(shapes.size()) {
    for (const std::string& name : table.cases) rows_.push_back(named_place_of(name));
    for (std::size_t row = 0; row < rows_.size(); ++row) {
      by_name_[rows_[row].stem].push_back(row);
      if (rows_[row].file != rows_[row].stem) by_name_[rows_[row].file].push_back(row);
    }
  }

  Result<std::vector<std::optional<std::size_t>>> find(const std::map<std::string, StudyCase>& studies) {
    for (std::size_t k = 0; k < shapes_.size(); ++k) {
      found_[k] = row_of_study(studies, shapes_[k]);
      if (!found_[k]) find_candidates(k);
    }
    keep_those_of_their_folder();
    if (auto chosen = choose(); !chosen) return fail(chosen.error());
    return std::move(found_);
  }

 private:
  std::optional<std::size_t> row_of_study(const std::map<std::string, StudyCase>& studies,
                                          const ShapeOfRow& shape) const {
    for (const std::string& key : shape.study_keys) {
      const auto of_study = studies.find(key);
      if (of_study == studies.end()) continue;
      const std::string& name = of_study->second.name;
      if (const auto exact = std::ranges::find(table_.cases, name); exact != table_.cases.end())
        return static_cast<std::size_t>(exact - table_.cases.begin());
      if (const auto rows = by_name_.find(name); rows != by_name_.end() && rows->second.size() == 1)
        return rows->second.front();
    }
    return std::nullopt;
  }

  void find_candidates(std::size_t shape) {
    const NamedPlace place = place_of_shape(shapes_[shape].name, are_files_);
    const auto rows = by_name_.find(place.stem);
    if (rows == by_name_.end()) return;
    for (const std::size_t row : rows->second) may_be_[shape].push_back(compared(row, rows_[row], place));
  }

  /// Takes out rows that name another folder than the shape's, unless the table speaks of other folders.
  void keep_those_of_their_folder() {
    bool named = false;
    std::size_t deepest = 0;
    for (const auto& rows : may_be_)
      for (const RowOfShape& one : rows) {
        named = named || (one.whole && one.folders > 0);
        deepest = std::max(deepest, one.folders);
      }
    for (auto& rows : may_be_)
      std::erase_if(rows, [&](const RowOfShape& one) {
        return !rows_[one.row].folders.empty() && !(named ? one.whole : one.folders == deepest);
      });
    for (auto& rows : may_be_) {  // the likest alone
      std::size_t most = 0;
      for (const RowOfShape& one : rows) most = std::max(most, one.likeness);
      std::erase_if(rows, [&](const RowOfShape& one) { return one.likeness < most; });
    }
  }

  Result<void> choose() {
    std::map<std::size_t, std::vector<std::size_t>> shapes_of;  // by row, the likest alone
    std::map<std::size_t, std::size_t> most;
    for (const auto& rows : may_be_)
      for (const RowOfShape& one : rows) most[one.row] = std::max(most[one.row], one.likeness);
    for (std::size_t k = 0; k < shapes_.size(); ++k) {
      auto& rows = may_be_[k];
      if (std::ranges::all_of(rows, [&](const RowOfShape& one) { return one.likeness < most[one.row]; })) continue;
      if (rows.size() > 1)
        return fail(table_.source, "has the rows " + table_.cases[rows[0].row] + " and " + table_.cases[rows[1].row] +
                                       ", and either may be of " + shapes_[k].name +
                                       "; name each by its shape's folder and file");
      shapes_of[rows.front().row].push_back(k);
    }
    for (const auto& [row, shapes] : shapes_of)
      for (const std::size_t k : shapes) {
        if (k != shapes.front() && is_same_file(k, shapes.front())) continue;
        if (k != shapes.front() && are_files_)
          return fail(table_.source, "has the row " + table_.cases[row] + ", which may be of " +
                                         shapes_[shapes.front()].name + " or of " + shapes_[k].name +
                                         "; write the folder into the names of its rows, as " +
                                         names_with_folders({shapes_[shapes.front()].name, shapes_[k].name}).front());
        found_[k] = row;
      }
    return {};
  }

  bool is_same_file(std::size_t a, std::size_t b) const {
    std::error_code ignored;
    const auto path = [&](std::size_t k) { return fs::absolute(shapes_[k].name, ignored).lexically_normal(); };
    return are_files_ && path(a) == path(b);
  }

  const CovariateTable& table_;
  const std::vector<ShapeOfRow>& shapes_;
  bool are_files_;
  std::vector<NamedPlace> rows_;
  std::map<std::string, std::vector<std::size_t>> by_name_;
  std::vector<std::optional<std::size_t>> found_;
  std::vector<std::vector<RowOfShape>> may_be_;  ///< of each shape
};

}  // namespace

Result<std::vector<std::optional<std::size_t>>> rows_of_shapes(const CovariateTable& table,
                                                               const std::map<std::string, StudyCase>& studies,
                                                               const std::vector<ShapeOfRow>& shapes, bool are_files) {
  return RowsOfShapes(table, shapes, are_files).find(studies);
}

}  // namespace homolog
