#include "core/case/structure.h"

#include <algorithm>
#include <type_traits>
#include <utility>

#include "core/case/members.h"
#include "core/mesh/files/mesh_frame.h"

namespace homolog {

const Shape* Structure::shape(int frame) const {
  const auto found = shapes.find(frame);
  return found == shapes.end() ? nullptr : found->second.get();
}

const ContourSet* Structure::contour_set(const std::string& id) const {
  const auto found = std::find_if(contours.begin(), contours.end(), [&](const auto& one) { return one->id == id; });
  return found == contours.end() ? nullptr : found->get();
}

void Structure::set_shape(int frame, Shape shape) {
  shapes.insert_or_assign(frame, std::make_shared<const Shape>(std::move(shape)));
}

Structure new_structure(std::shared_ptr<const Template> the_template, const Similarity& placement) {
  Structure structure;
  structure.paint = {std::make_shared<const VertexScalars>(the_template->stiffness),
                     std::make_shared<const Regions>(the_template->regions), the_template->stiffness_base};
  Shape shape;
  shape.placement = shape.before_landmarks = placement;
  shape.placed = std::make_shared<const Points>(placement.apply(the_template->points));
  shape.reference = shape.points = shape.placed;
  structure.the_template = std::move(the_template);
  structure.set_shape(0, std::move(shape));
  return structure;
}

MeshFile painted_template(const Structure& structure) {
  MeshFile file = to_mesh_file(*structure.the_template);
  file.stiffness = structure.paint.stiffness;
  file.stiffness_base = structure.paint.base;
  file.regions = *structure.paint.regions;
  return file;
}

namespace {

/// What the last fit says of each vertex goes into the file. The doubt of a confirmed vertex is gone.
void keep_fit_values(const Shape& shape, MeshFile& file) {
  for_each_member(shape_members, [&]<class Value>(const Member<Shape, Value>& member) {
    if constexpr (std::is_same_v<Value, std::shared_ptr<const VertexScalars>>) {
      if (member.origin != Origin::fit || !(shape.*member.of)) return;
      file.*fit_value(member.key)->of = member.of == &Shape::doubt_mm ? doubt_left_mm(shape) : *(shape.*member.of);
    }
  });
}

constexpr bool all_fit_values_are_written() {
  bool all = true;
  for_each_member(shape_members, [&]<class Value>(const Member<Shape, Value>& member) {
    const bool of_vertices = std::is_same_v<Value, std::shared_ptr<const VertexScalars>>;
    if (member.origin == Origin::fit && (!of_vertices || fit_value(member.key) == nullptr)) all = false;
  });
  return all;
}
static_assert(all_fit_values_are_written(), "name each member that the last fit says in fit_values too");

}  // namespace

MeshFile to_mesh_file(const ShapeView& view, bool of_cine) {
  const Shape& shape = view.shape;
  MeshFile file = painted_template(view.structure);
  file.points = *shape.points;
  file.comments.clear();
  if (const auto& faced = view.the_template().faced) file.comments.push_back(faced_comment(*faced));
  if (const double share = missing_share_of(view.the_template(), shape); share > 0)
    file.comments.push_back(missing_share_comment(share));
  file.landmarks.clear();
  for (const auto& [name, position] : shape.landmarks) file.landmarks.push_back({name, position});
  keep_fit_values(shape, file);
  if (of_cine) note_frame(file, view.frame);
  return file;
}

}  // namespace homolog
