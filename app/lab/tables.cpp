#include "app/lab/tables.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
#include <sstream>

#include "core/base/files/files.h"
#include "core/model/files/model_files.h"

namespace homolog {

namespace {

/// The numbers of one column; what is null is left out.
std::vector<double> column(const std::vector<Json>& rows, const char* name) {
  std::vector<double> values;
  for (const Json& row : rows)
    if (row.contains(name) && row[name].is_number()) values.push_back(row[name].get<double>());
  return values;
}

Json mean(const std::vector<double>& values) {
  if (values.empty()) return {};
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Null where the middle lies among the `missing`, which count as larger than any value.
Json median(std::vector<double> values, std::size_t missing) {
  values.resize(values.size() + missing, std::numeric_limits<double>::infinity());
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const double middle = (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
  return std::isfinite(middle) ? Json(middle) : Json();
}

std::string text_of(const Json& row, const char* name, int decimals) {
  if (!row.contains(name) || row[name].is_null()) return "–";
  if (!row[name].is_number()) return row[name].get<std::string>();
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", decimals, row[name].get<double>());
  return text;
}

/// "6.29 → 3.00 → 2.12", with a dash where nothing is known.
std::string landmark_text(const Json& row) {
  if (text_of(row, "landmarks_mm", 2) == "–") return "–";
  return text_of(row, "landmarks_placed_mm", 2) + " → " + text_of(row, "landmarks_after_features_mm", 2) + " → " +
         text_of(row, "landmarks_mm", 2);
}

std::string reached_text(const Json& row) {
  if (!row.contains("reached_1mm")) return "–";
  return text_of(row, "pulls_to_1mm", 1) + " (" + text_of(row, "reached_1mm", 0) + " of " + text_of(row, "cases", 0) +
         ")";
}

}  // namespace

Json summary_of_runs(const std::string& scheme, const std::vector<Json>& runs) {
  Json row{{"scheme", scheme}, {"cases", runs.size()}};
  for (const char* name : {"landmarks_placed_mm", "landmarks_after_features_mm", "landmarks_mm", "assd_placed_mm",
                           "assd_mm", "hd95_mm", "dice", "feature_strokes"})
    row[name] = mean(column(runs, name));
  row["pulls"] = median(column(runs, "pulls"), 0);
  const std::vector<double> reached = column(runs, "pulls_to_1mm");
  row["reached_1mm"] = reached.size();
  row["pulls_to_1mm"] = median(reached, runs.size() - reached.size());
  row["edge_spread"] = mean(column(runs, "edge_spread"));
  const auto angles = column(runs, "min_angle_deg"), turned = column(runs, "turned_triangles");
  if (!angles.empty()) row["min_angle_deg"] = *std::min_element(angles.begin(), angles.end());
  row["turned_triangles"] = std::accumulate(turned.begin(), turned.end(), 0.0);
  return row;
}

Result<void> write_csv(const std::vector<Json>& rows, const std::filesystem::path& path) {
  std::vector<std::string> names;
  for (const Json& row : rows)
    for (const auto& [name, value] : row.items())
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  return write_whole_file(path, [&](std::ostream& out) -> Result<void> {
    for (std::size_t k = 0; k < names.size(); ++k) out << (k > 0 ? "," : "") << names[k];
    out << '\n';
    for (const Json& row : rows) {
      for (std::size_t k = 0; k < names.size(); ++k) {
        if (k > 0) out << ',';
        if (!row.contains(names[k]) || row[names[k]].is_null()) continue;
        const Json& value = row[names[k]];
        out << (value.is_string() ? csv_field(value.get<std::string>()) : value.dump());
      }
      out << '\n';
    }
    return {};
  });
}

std::string markdown_table(const std::vector<Json>& rows) {
  std::ostringstream out;
  out << "| scheme | landmarks not shown: placed → features → end | strokes: features + pulls | pulls to 1 mm | "
         "distance | Dice | edge spread | smallest angle | turned | modes | generalisation | specificity |\n"
      << "|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Json& row : rows) {
    out << "| " << row["scheme"].get<std::string>() << " | " << landmark_text(row) << " | "
        << text_of(row, "feature_strokes", 0) << " + " << text_of(row, "pulls", 0) << " | " << reached_text(row)
        << " | " << text_of(row, "assd_mm", 2) << " | " << text_of(row, "dice", 3) << " | "
        << text_of(row, "edge_spread", 3) << " | " << text_of(row, "min_angle_deg", 1) << " | "
        << text_of(row, "turned_triangles", 0) << " | " << text_of(row, "modes_95", 0) << " | "
        << text_of(row, "generalization_rms", 2) << " | " << text_of(row, "specificity_rms", 2) << " |\n";
  }
  return out.str();
}

}  // namespace homolog
