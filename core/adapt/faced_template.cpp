#include "core/adapt/faced_template.h"

#include <utility>

#include "core/adapt/boundary/boundary.h"
#include "core/template_making/template_file.h"

namespace homolog {

Result<MeshTemplate> make_faced_template(const Volume& mask, const FacedLabels& faced,
                                         const FacedTemplateOptions& options, Progress* progress) {
  auto boundary = label_boundary(mask, options.label, options.frame, options.closing_mm, options.vertices);
  if (!boundary) return fail(boundary.error());
  auto part = faced_part(boundary->surface, mask, options.label, options.frame, faced);
  if (!part) return fail(part.error());
  MeshTemplate made;
  made.mesh = spread_over(*part, options.vertices, progress);
  if (progress != nullptr && progress->cancelled()) return fail("", "the making of the template was cancelled");
  made.to_mesh = surface_distance(made.mesh, *part);
  made.from_mesh = surface_distance(*part, made.mesh);
  made.warnings = std::move(boundary->warnings);
  return made;
}

MeshFile faced_template_file(const Mesh& mesh, const std::string& source, const FacedNames& faced,
                             const FacedTemplateOptions& options) {
  MeshFile file = template_file(mesh, {{"source", source},
                                       {"label", options.label},
                                       {"frame", options.frame},
                                       {"vertices", options.vertices},
                                       {faced.kept ? "facing" : "open_at", faced.labels}});
  file.comments.push_back(faced_comment(faced));
  return file;
}

}  // namespace homolog
