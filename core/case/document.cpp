#include "core/case/document.h"

#include "core/mesh/mesh_frame.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

MeshFile painted_template(const Document& document) {
  MeshFile file = to_mesh_file(*document.the_template);
  file.stiffness = *document.stiffness;
  file.stiffness_base = document.stiffness_base;
  file.regions = *document.regions;
  return file;
}

MeshFile to_mesh_file(const Document& document, int frame) {
  const Shape& shape = document.shapes.at(frame);
  MeshFile file = painted_template(document);
  file.points = *shape.points;
  file.comments.clear();
  if (const double share = missing_share_of(*document.the_template, shape); share > 0)
    file.comments.push_back(missing_share_comment(share));
  file.landmarks.clear();
  for (const auto& [name, position] : shape.landmarks) file.landmarks.push_back({name, position});
  if (VertexScalars doubt_mm = doubt_left_mm(shape); doubt_mm.size() > 0) file.doubt_mm = std::move(doubt_mm);
  if (shape.outlier) file.outlier = *shape.outlier;
  if (document.volume && document.volume->frames > 1) note_frame(file, frame);
  return file;
}

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

Document new_document(std::string volume_source, std::shared_ptr<const Volume> volume,
                      std::shared_ptr<const Template> the_template, const std::optional<Similarity>& placement) {
  Document document;
  document.volume_source = std::move(volume_source);
  document.volume = std::move(volume);
  document.the_template = std::move(the_template);
  if (!document.the_template) return document;
  const Template& placed = *document.the_template;
  document.stiffness = std::make_shared<const VertexScalars>(placed.stiffness);
  document.regions = std::make_shared<const Regions>(placed.regions);
  document.stiffness_base = placed.stiffness_base;
  Shape shape;
  if (placement) {
    shape.placement = *placement;
  } else if (document.volume) {
    shape.placement.translation = document.volume->geometry.bounds_mm().center() - bounds_of(placed.points).center();
  }
  shape.before_landmarks = shape.placement;
  shape.placed = std::make_shared<const Points>(shape.placement.apply(placed.points));
  shape.reference = shape.points = shape.placed;
  document.shapes.emplace(0, std::move(shape));
  return document;
}

}  // namespace homolog
