#include "core/model/measures/sizes.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "core/mesh/mesh_quality.h"
#include "core/mesh/repair/inside_out.h"
#include "core/model/alignment/procrustes.h"
#include "core/model/files/model_files.h"

namespace homolog {

namespace {

const Vec3* landmark_of(const ShapeSizes& sizes, const std::string& name) {
  for (const Landmark& landmark : sizes.landmarks)
    if (landmark.name == name) return &landmark.position;
  return nullptr;
}

std::string number_field(const std::optional<double>& value) {
  if (!value) return ",";
  char text[40];
  std::snprintf(text, sizeof text, ",%.6g", *value);
  return text;
}

}  // namespace

Result<ShapeSizes> sizes_of(const MeshFile& mesh, std::shared_ptr<const Topology>& faces) {
  ShapeSizes sizes;
  sizes.landmarks = mesh.landmarks;
  sizes.centroid_size_mm = centroid_size_mm(mesh.points);
  if (mesh.triangles.rows() == 0) return sizes;
  if (auto shared = shared_topology(mesh, faces); !shared) return fail(shared.error());
  const Mesh shape{faces, mesh.points};
  double twice_area = 0;
  for (Eigen::Index face = 0; face < mesh.triangles.rows(); ++face) twice_area += area_normal(shape, face).norm();
  (faces->closed() ? sizes.volume_ml : sizes.volume_capped_ml) = enclosed_volume_ml(shape);
  sizes.area_mm2 = twice_area / 2;
  sizes.inward = inside_out(shape).value_or("");
  return sizes;
}

std::vector<LandmarkPair> landmark_pairs(const std::vector<ShapeSizes>& shapes) {
  std::vector<LandmarkPair> pairs;
  std::set<LandmarkPair> known;
  for (const ShapeSizes& one : shapes)
    for (std::size_t a = 0; a < one.landmarks.size(); ++a)
      for (std::size_t b = a + 1; b < one.landmarks.size(); ++b) {
        const LandmarkPair pair{one.landmarks[a].name, one.landmarks[b].name};
        if (known.contains(pair)) continue;
        known.insert(pair);
        known.emplace(pair.second, pair.first);
        pairs.push_back(pair);
      }
  return pairs;
}

std::optional<double> distance_mm(const ShapeSizes& sizes, const LandmarkPair& pair) {
  const Vec3* from = landmark_of(sizes, pair.first);
  const Vec3* to = landmark_of(sizes, pair.second);
  if (from == nullptr || to == nullptr) return std::nullopt;
  return (*to - *from).norm();
}

Spread spread_of(const std::vector<std::optional<double>>& values) {
  Spread spread;
  for (const auto& value : values) {
    if (!value) continue;
    ++spread.count;
    spread.mean += *value;
  }
  if (spread.count == 0) return spread;
  spread.mean /= static_cast<double>(spread.count);
  double squares = 0;
  for (const auto& value : values)
    if (value) squares += (*value - spread.mean) * (*value - spread.mean);
  if (spread.count > 1) spread.sd = std::sqrt(squares / static_cast<double>(spread.count - 1));
  return spread;
}

std::string sizes_table(const std::vector<std::string>& names, const std::vector<ShapeSizes>& shapes,
                        const std::vector<std::string>& groups) {
  const std::vector<LandmarkPair> pairs = landmark_pairs(shapes);
  const bool open = std::ranges::any_of(shapes, [](const ShapeSizes& one) { return one.volume_capped_ml.has_value(); });
  std::string table = open ? "case,volume_ml,volume_capped_ml,area_mm2" : "case,volume_ml,area_mm2";
  for (const auto& [from, to] : pairs) table += ',' + csv_field(from + " to " + to + " mm");
  table += groups.empty() ? ",centroid_size_mm\n" : ",centroid_size_mm,group\n";
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    table += csv_field(names[k]) + number_field(shapes[k].volume_ml);
    if (open) table += number_field(shapes[k].volume_capped_ml);
    table += number_field(shapes[k].area_mm2);
    for (const LandmarkPair& pair : pairs) table += number_field(distance_mm(shapes[k], pair));
    table += number_field(shapes[k].centroid_size_mm);
    if (!groups.empty()) table += ',' + csv_field(groups[k]);
    table += '\n';
  }
  return table;
}

}  // namespace homolog
