#include "app/lab/chart.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace homolog {

namespace {

constexpr double label_px = 130, width_px = 640, margin_px = 24, row_px = 22;
constexpr const char* keys[] = {"landmarks_placed_mm", "landmarks_after_features_mm", "landmarks_mm"};

/// From mm to the picture.
struct Axis {
  double most_mm;
  double at(double mm) const { return label_px + (width_px - label_px - margin_px) * mm / most_mm; }
};

void draw_axis(std::ostream& out, const Axis& axis, double bottom_px) {
  for (double mm = 0; mm <= axis.most_mm; ++mm) {
    out << "<line x1='" << axis.at(mm) << "' y1='" << margin_px << "' x2='" << axis.at(mm) << "' y2='" << bottom_px
        << "' stroke='#ddd'/>\n<text x='" << axis.at(mm) << "' y='" << bottom_px + 16 << "' text-anchor='middle'>" << mm
        << (mm + 1 > axis.most_mm ? " mm" : "") << "</text>\n";
  }
}

void draw_row(std::ostream& out, const Axis& axis, const Json& row, double y_px) {
  const double placed = axis.at(row[keys[0]]), features = axis.at(row[keys[1]]), end = axis.at(row[keys[2]]);
  out << "<text x='" << label_px - 10 << "' y='" << y_px + 4 << "' text-anchor='end'>"
      << row["scheme"].get<std::string>() << "</text>\n<line x1='" << std::min({placed, features, end}) << "' y1='"
      << y_px << "' x2='" << std::max({placed, features, end}) << "' y2='" << y_px << "' stroke='#999'/>\n<circle cx='"
      << placed << "' cy='" << y_px << "' r='5' fill='white' stroke='#999'/>\n<circle cx='" << features << "' cy='"
      << y_px << "' r='3' fill='#999'/>\n<circle cx='" << end << "' cy='" << y_px << "' r='5' fill='#1f6fb4'/>\n";
}

}  // namespace

std::string landmark_chart(const std::vector<Json>& rows) {
  std::vector<const Json*> known;
  double most_mm = 0;
  for (const Json& row : rows) {
    if (!row.contains(keys[2]) || row[keys[2]].is_null()) continue;
    known.push_back(&row);
    for (const char* name : keys) most_mm = std::max(most_mm, row[name].get<double>());
  }
  if (known.empty()) return {};
  const Axis axis{std::ceil(most_mm)};
  const double bottom_px = margin_px + row_px * static_cast<double>(known.size());
  std::ostringstream out;
  out << "<svg xmlns='http://www.w3.org/2000/svg' width='" << width_px << "' height='" << bottom_px + margin_px
      << "' font-family='sans-serif' font-size='12'>\n<rect width='100%' height='100%' fill='white'/>\n";
  draw_axis(out, axis, bottom_px);
  for (std::size_t k = 0; k < known.size(); ++k)
    draw_row(out, axis, *known[k], margin_px + row_px * (static_cast<double>(k) + 0.5));
  out << "</svg>\n";
  return out.str();
}

}  // namespace homolog
