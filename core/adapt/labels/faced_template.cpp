#include "core/adapt/labels/faced_template.h"

#include <utility>

#include "core/adapt/boundary/boundary.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/template_making/template_file.h"

namespace homolog {

Result<FacedTemplate> make_faced_template(const Volume& mask, const FacedLabels& faced,
                                          const FacedTemplateOptions& options, Progress* progress) {
  const auto boundary = label_boundary(mask, options.label, options.frame, options.closing_mm, options.vertices);
  if (!boundary) return fail(boundary.error());
  auto part = faced_part(boundary->surface, mask, options.label, options.frame, faced);
  if (!part) return fail(part.error());
  FacedTemplate made;
  if (auto left_out = take_largest_piece(*part, options.label)) made.warnings.push_back(std::move(*left_out));
  made.mesh = spread_over(*part, options.vertices, progress);
  if (progress != nullptr && progress->cancelled()) return fail("", "the making of the template was cancelled");
  made.to_mesh = surface_distance(made.mesh, *part);
  made.from_mesh = surface_distance(*part, made.mesh);
  for (Eigen::Index i = 0; i < made.mesh.points.rows(); ++i)
    if (!boundary->shows(made.mesh.points.row(i).transpose())) made.cut.push_back(static_cast<std::int32_t>(i));
  if (!made.cut.empty())
    made.warnings.push_back(label_name(options.label) +
                            " is cut off by the border of the label map; the organ is closed flat there; use a map "
                            "that holds the whole organ");
  return made;
}

MeshFile faced_template_file(const Mesh& mesh, const std::string& source, const FacedNames& faced,
                             const FacedTemplateOptions& options, const std::vector<int>& labels) {
  nlohmann::ordered_json provenance{{"source", source}, {"label", options.label}};
  if (labels.size() > 1) provenance["label"] = labels;
  provenance["frame"] = options.frame;
  provenance["vertices"] = options.vertices;
  provenance[faced.kept ? "facing" : "open_at"] = faced.labels;
  MeshFile file = template_file(mesh, provenance);
  file.comments.push_back(faced_comment(faced));
  return file;
}

}  // namespace homolog
