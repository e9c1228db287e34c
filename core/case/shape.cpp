#include "core/case/shape.h"

#include "core/mesh/mesh_quality.h"

namespace homolog {

VertexScalars doubt_left_mm(const Shape& shape) {
  if (!shape.doubt_mm) return {};
  return shape.confirmed ? shape.doubt_mm->cwiseProduct((1 - shape.confirmed->array()).matrix()) : *shape.doubt_mm;
}

double missing_share_of(const Template& the_template, const Shape& shape) {
  const double share = the_template.missing_share;
  if (share <= 0) return 0;
  const double placed_ml = enclosed_volume_ml({the_template.topology, *shape.placed});
  return enclosed_volume_ml({the_template.topology, *shape.points}) > (1 + share / 2) * placed_ml ? 0 : share;
}

bool frame_is_known(const Shape& shape) {
  if (shape.confirmed && (shape.confirmed->array() > 0).any()) return true;
  const bool as_carried = shape.carried && (shape.carried == shape.points || *shape.carried == *shape.points);
  return shape.strokes > 0 && !as_carried;
}

VertexScalars known_vertices(const Shape& shape) {
  constexpr double followed = 0.6;  // below it a stroke carried a vertex along and did not decide its place
  VertexScalars known = VertexScalars::Zero(shape.points->rows());
  if (shape.decided) known = (shape.decided->array() >= followed).cast<double>();
  if (shape.confirmed) known = known.cwiseMax(*shape.confirmed);
  return known;
}

Points unaided_points(const Shape& shape) {
  if (!shape.unaided) return *shape.points;
  const VertexScalars known = known_vertices(shape);
  return *shape.unaided + known.asDiagonal() * (*shape.points - *shape.unaided);
}

}  // namespace homolog
