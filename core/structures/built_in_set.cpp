#include "core/structures/built_in_set.h"

#include "core/catalogue/catalogue.h"
#include "core/phantom/phantom_scene.h"
#include "core/volume/labels/segmentation.h"

namespace homolog {

Result<BuiltInSet> built_in_set(const std::string& source) {
  if (source != built_in_set_source())
    return fail(source, "is no built-in set of templates; choose " + built_in_set_source());
  constexpr double near_mm = 5;
  BuiltInSet made;
  std::vector<Mesh> meshes;
  Segmentation coloured;
  for (SceneStructure& one : spine_phantom_truth(0)) {
    auto topology = Topology::make(one.truth.points.rows(), one.truth.triangles);
    if (!topology) return fail(source, topology.error().what);
    meshes.push_back({*topology, one.truth.points});
    TemplateOfSet structure;
    structure.name = one.name;
    structure.value = one.value;
    coloured.add({.name = one.name, .value = one.value});
    structure.file = built_in_set_source(one.name);
    made.set.structures.push_back(std::move(structure));
    made.templates.push_back(std::move(one.truth));
  }
  colour_by_names(coloured);
  for (TemplateOfSet& one : made.set.structures) one.colour = coloured.find(one.value)->colour;
  find_partners(made.set);
  find_neighbours(made.set, meshes, near_mm);
  return made;
}

bool names_set(const std::string& source) {
  return is_template_set(source) || source == built_in_set_source();
}

Result<TemplateSet> load_template_set(const std::string& source) {
  if (!is_built_in(source)) return read_template_set(source);
  auto made = built_in_set(source);
  if (!made) return fail(made.error());
  return std::move(made->set);
}

}  // namespace homolog
