#include "core/mesh/formats/vertex_arrays.h"

#include <algorithm>

#include "core/base/text/text.h"

namespace homolog::formats {

std::vector<std::pair<std::string, VertexScalars>> vertex_arrays(const MeshFile& mesh) {
  std::vector<std::pair<std::string, VertexScalars>> arrays;
  if (mesh.stiffness) arrays.emplace_back("stiffness", *mesh.stiffness);
  for (const FitValue& value : fit_values)
    if (const auto& values = mesh.*value.of) arrays.emplace_back(value.name, *values);
  if (!mesh.regions.list.empty()) {
    VertexScalars regions(mesh.points.rows());
    for (Eigen::Index i = 0; i < regions.size(); ++i) regions[i] = mesh.regions.of_vertex[i];
    arrays.emplace_back("region", std::move(regions));
  }
  for (const auto& [name, values] : mesh.values) arrays.emplace_back(name, values);
  return arrays;
}

std::string left_out(std::string_view name) {
  return "its values \"" + excerpt(name) + "\" are cut short or damaged and were left out; copy or export it again";
}

void keep_vertex_array(std::string_view name, VertexScalars values, MeshFile& mesh) {
  const bool fits = values.size() == mesh.points.rows() && values.allFinite();
  const bool is_ours = name == "stiffness" || name == "region" || fit_value(name) != nullptr;
  if (is_ours && (!fits || (name == "stiffness" && !(values.minCoeff() > 0)))) mesh.warnings.push_back(left_out(name));
  if (!fits) return;
  if (name == "stiffness") {
    if (values.minCoeff() > 0) mesh.stiffness = std::make_shared<const VertexScalars>(std::move(values));
  } else if (const FitValue* said = fit_value(name)) {
    mesh.*said->of = std::move(values);
  } else if (name == "region") {
    const double most = values.maxCoeff();
    if (!(values.minCoeff() >= 0) || !(most >= 1) || most > 255) return;
    for (int k = 1; k <= static_cast<int>(most); ++k)
      mesh.regions.list.push_back({"region " + std::to_string(k), 1, {}});
    for (const double value : values) mesh.regions.of_vertex.push_back(static_cast<std::uint8_t>(value));
  } else {
    mesh.arrays.emplace(std::string(name), std::move(values));
  }
}

}  // namespace homolog::formats
