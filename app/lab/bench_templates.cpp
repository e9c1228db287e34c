#include "app/lab/bench_templates.h"

#include <algorithm>
#include <chrono>
#include <limits>

#include "app/lab/median.h"
#include "core/mesh/mesh_quality.h"
#include "core/template_making/mask_template.h"
#include "core/volume/volume_io.h"

namespace homolog {

namespace {

using Clock = std::chrono::steady_clock;

Json row_of(const MaskTemplate& made, double largest_spacing_mm) {
  const MeshQuality quality = mesh_quality(made.mesh);
  return {{"vertices", made.mesh.points.rows()},
          {"genus", made.mesh.topology->genus()},
          {"edge_cv", quality.edge_cv},
          {"min_angle_deg", quality.min_angle_deg},
          {"self_intersections", quality.self_intersections},
          {"to_mask_mean_mm", made.to_mask.mean_mm},
          {"from_mask_mean_mm", made.from_mask.mean_mm},
          {"to_mask_share_of_spacing", made.to_mask.mean_mm / largest_spacing_mm},
          {"tunnels_cut", made.tunnels.size()}};
}

/// What a column's worst and middle values are over all rows that have it.
Json summary_of(const Json& rows) {
  Json summary{{"templates", rows.size()}};
  for (const char* column : {"genus", "edge_cv", "min_angle_deg", "self_intersections", "to_mask_mean_mm",
                             "from_mask_mean_mm", "to_mask_share_of_spacing", "ms"}) {
    std::vector<double> values;
    for (const Json& row : rows)
      if (row.contains(column)) values.push_back(row[column].get<double>());
    if (values.empty()) continue;
    std::sort(values.begin(), values.end());
    summary[column] = {{"min", values.front()}, {"median", values[values.size() / 2]}, {"max", values.back()}};
  }
  return summary;
}

}  // namespace

Json template_figures(const std::vector<std::filesystem::path>& masks, int vertices, Progress& progress) {
  Json rows = Json::array();
  for (std::size_t m = 0; m < masks.size() && !progress.cancelled(); ++m) {
    progress.report(static_cast<double>(m) / static_cast<double>(masks.size()));
    const std::string name = masks[m].filename().string();
    const auto mask = read_volume(masks[m], {});
    if (!mask) {
      rows.push_back({{"mask", name}, {"refused", mask.error().what}});
      continue;
    }
    for (const auto& [label, voxels] : labels_of(mask->volume)) {
      MaskTemplateOptions options;
      options.label = label;
      options.vertices = vertices;
      const auto begin = Clock::now();
      const auto made = make_mask_template(mask->volume, options);
      const double ms = milliseconds(Clock::now() - begin);
      Json row{{"mask", name}, {"label", label}};
      row.update(made ? row_of(*made, mask->volume.geometry.spacing_mm.maxCoeff())
                      : Json{{"refused", made.error().what}});
      row["ms"] = ms;
      rows.push_back(std::move(row));
    }
  }
  const Json summary = summary_of(rows);
  return {{"rows", std::move(rows)}, {"summary", summary}};
}

}  // namespace homolog
