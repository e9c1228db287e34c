#include "core/model/joint_models/structure_parts.h"

#include <algorithm>
#include <numbers>

#include "core/base/text/text.h"

namespace homolog {

Eigen::MatrixXd StructurePoses::in_mm() const {
  Eigen::MatrixXd scaled = values;
  for (Eigen::Index k = 0; k < radius_mm.size(); ++k) {
    scaled.middleRows(numbers * k + 3, 3) *= radius_mm[k] * std::numbers::pi / 180;
    scaled.row(numbers * k + 6) *= radius_mm[k];
  }
  return scaled;
}

const StructurePart* part_named(const std::vector<StructurePart>& parts, const std::string& name) {
  const auto found = std::find_if(parts.begin(), parts.end(),
                                  [&](const StructurePart& part) { return lower_case(part.name) == lower_case(name); });
  return found == parts.end() ? nullptr : &*found;
}

ShapeMatrix rows_of(const StructurePart& part, const ShapeMatrix& shapes) {
  return shapes.middleRows(3 * part.first_vertex, 3 * part.vertices);
}

Triangles triangles_of(const StructurePart& part, const Triangles& triangles) {
  return triangles.middleRows(part.first_triangle, part.triangles).array() -
         static_cast<std::int32_t>(part.first_vertex);
}

}  // namespace homolog
