#include "app/verbs/model/model_part.h"

#include <vector>

#include "core/base/text/listed.h"
#include "core/base/text/nearest_names.h"
#include "core/model/files/statismo.h"

namespace homolog {

Result<ShapeModel> read_model_part(const std::filesystem::path& path, const std::string& structure) {
  auto model = read_model(path);
  if (!model || structure.empty()) return model;
  if (model->parts.empty()) return fail(path.string(), "is a model of one structure; leave --structure out");
  if (const StructurePart* part = part_named(model->parts, structure)) return part_of(*model, *part);
  std::vector<std::string> names;
  for (const StructurePart& part : model->parts) names.push_back(part.name);
  return fail(path.string(), "has no structure " + structure + "; name one that it has, as " +
                                 listed(nearest_names(structure, std::move(names), 3), " or "));
}

Result<MeshFile> mesh_of_model(const std::filesystem::path& path, const std::string& structure,
                               std::optional<std::uint64_t> seed) {
  const auto model = read_model_part(path, structure);
  if (!model) return fail(model.error());
  MeshFile mesh;
  mesh.points = seed ? sampled_shape(*model, *seed) : Points(points_of(model->mean));
  mesh.triangles = model->topology;
  return mesh;
}

}  // namespace homolog
