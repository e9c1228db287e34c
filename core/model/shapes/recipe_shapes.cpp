#include "core/model/shapes/recipe_shapes.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "core/mesh/construction/mirror.h"
#include "core/model/alignment/procrustes.h"
#include "core/model/files/model_files.h"

namespace homolog {

Result<MeasuredStructure> measured_structure(std::string name, const MeshFile& mesh,
                                             std::shared_ptr<const Topology>& faces) {
  MeasuredStructure structure{std::move(name), {nullptr, mesh.points}, mesh.landmarks, mesh.regions};
  if (mesh.triangles.rows() == 0) return structure;
  if (auto shared = shared_topology(mesh, faces); !shared) return fail(shared.error());
  structure.mesh.topology = faces;
  return structure;
}

void Lenders::add(const MeasuredShape& shape) {
  for (const MeasuredStructure& one : shape.structures) {
    if (one.mesh.topology == nullptr || (one.landmarks.empty() && one.regions.list.empty())) continue;
    MeshFile file;
    file.points = one.mesh.points;
    file.triangles = one.mesh.topology;
    file.landmarks = one.landmarks;
    file.regions = one.regions;
    if (auto made = make_template(std::move(file), one.name)) add(std::move(*made));
  }
}

bool Lenders::lend_to(MeasuredShape& shape) const {
  bool suits_one = false;
  for (MeasuredStructure& one : shape.structures)
    for (const auto& lender : lenders_) {
      if (lender->points.rows() != one.mesh.points.rows()) continue;
      const Triangles& faces = lender->topology->triangles();
      // Points alone are taken to be in the lender's order.
      if (one.mesh.topology != nullptr && !same_faces(one.mesh.topology->triangles(), faces) &&
          !turned_faces(one.mesh.topology->triangles(), faces))
        continue;
      suits_one = true;
      for (Landmark& landmark : carried_landmarks(*lender, one.mesh.points)) {
        const auto same = [&](const Landmark& own) { return own.name == landmark.name; };
        if (std::ranges::none_of(one.landmarks, same)) one.landmarks.push_back(std::move(landmark));
      }
      if (one.regions.list.empty()) one.regions = lender->regions;
    }
  return suits_one;
}

std::string unsuited_template(const std::string& the_template, const std::string& what) {
  return the_template + ": has other vertices or faces than " + what +
         ", so its landmarks and regions are not used; give the template of the fits";
}

Result<MeasuredShape> measured_shape(const ShapeModel& model, const Points& points) {
  MeasuredShape shape;
  if (model.parts.empty()) {
    shape.structures.push_back({"", {model.topology, points}, {}, {}});
    return shape;
  }
  for (const StructurePart& part : model.parts) {
    MeshFile mesh;
    mesh.points = points.middleRows(part.first_vertex, part.vertices);
    if (model.topology) mesh.triangles = triangles_of(part, model.topology->triangles());
    std::shared_ptr<const Topology> faces;
    auto structure = measured_structure(part.name, mesh, faces);
    if (!structure) return fail(structure.error());
    shape.structures.push_back(std::move(*structure));
  }
  return shape;
}

MeasuredShape measured_shape(const Document& document, const std::string& structure) {
  MeasuredShape measured{{}, document.scan.image.get(), document.frame};
  const Structure* first = document.structure(structure);
  const auto add = [&](const Structure& of, const Shape& shape) {
    MeasuredStructure one{of.name.empty() ? of.id : of.name, {of.the_template->topology, *shape.points}, {}, {}};
    for (const auto& [name, place_mm] : shape.landmarks) one.landmarks.push_back({name, place_mm});
    for (Landmark& landmark : carried_landmarks(*of.the_template, *shape.points))
      if (!shape.landmarks.contains(landmark.name)) one.landmarks.push_back(std::move(landmark));
    one.regions = *of.paint.regions;
    measured.structures.push_back(std::move(one));
  };
  add(*first, *first->shape(document.frame));
  for (const auto& other : document.structures)
    if (const Shape* shape = other->shape(document.frame); shape != nullptr && other.get() != first)
      add(*other, *shape);
  return measured;
}

std::string measurement_columns(const Recipe& recipe) {
  std::string text;
  for (const std::size_t k : recipe.measurements)
    text += ',' + csv_field(recipe.steps[k].name + (recipe.steps[k].unit == "1" ? "" : ' ' + recipe.steps[k].unit));
  return text;
}

std::string measurement_cells(const std::vector<MeasuredNumber>& values) {
  std::string text;
  for (const MeasuredNumber& one : values) {
    char number[40] = "";
    if (one.value) std::snprintf(number, sizeof number, "%.9g", *one.value);
    text += std::string(",") + number;
  }
  return text;
}

Result<std::vector<ModeValues>> measure_modes(const Recipe& recipe, const ShapeModel& model, int modes,
                                              const Lenders& lenders, Progress& progress, int most_sd) {
  std::vector<ModeValues> all;
  for (int mode = 1; mode <= modes; ++mode)
    for (int sd = -most_sd; sd <= most_sd; ++sd) {
      if (progress.cancelled()) return fail("", "the measurements were cancelled");
      progress.report(static_cast<double>(all.size()) / ((2 * most_sd + 1) * modes));
      auto shape = measured_shape(model, mode_shape(model, mode - 1, sd));
      if (!shape) return fail(shape.error());
      lenders.lend_to(*shape);
      all.push_back({mode, static_cast<double>(sd), measure(recipe, *shape)});
    }
  return all;
}

}  // namespace homolog
