#include "app/verbs/study/study_templates.h"

#include <algorithm>

#include "core/catalogue/catalogue.h"
#include "core/mesh/construction/mirror.h"
#include "core/model/shapes/study.h"

namespace homolog {

namespace fs = std::filesystem;

Result<bool> mirrors_template(const MeshFile& mesh, const fs::path& file, const Template& the_template) {
  const std::string remedy = "; give the template that it was fitted with";
  if (mesh.points.rows() != the_template.points.rows())
    return fail(file.string(), "has " + std::to_string(mesh.points.rows()) + " vertices where " + the_template.source +
                                   " has " + std::to_string(the_template.points.rows()) + remedy);
  const Triangles& wanted = the_template.topology->triangles();
  if (mesh.triangles.rows() == 0 || same_faces(mesh.triangles, wanted)) return false;
  if (turned_faces(mesh.triangles, wanted)) return true;
  return fail(file.string(), "has other faces than " + the_template.source + remedy);
}

Result<void> check_template_of_case(const fs::path& file, const std::string& structure, const Template& the_template,
                                    ReadTogether& together) {
  const auto shapes = read_shapes_of(file, together);
  if (!shapes) return {};
  const ShapesOfStructure* taken = shapes->structure(structure);
  if (taken == nullptr || taken->frames.empty()) return {};
  const auto ours = mirrors_template(*taken->frames.begin()->second, file, the_template);
  return ours ? Result<void>() : fail(ours.error());
}

Result<void> check_template_of_study(const fs::path& study,
                                     const std::vector<std::shared_ptr<const Template>>& templates,
                                     const std::string& of_them, const std::string& remedy) {
  std::error_code ignored;
  if (!fs::exists(study, ignored)) return {};
  const auto read = read_study(study);
  if (!read) return fail(read.error());
  const std::string known = read->study.template_file.string();
  if (read->study.cases.empty() || known.empty()) return {};
  const auto other = load_template(known);  // one that is gone says nothing
  if (!other) return {};
  const auto is_same = [&](const std::shared_ptr<const Template>& one) {
    return one && one->topology->triangles() == (*other)->topology->triangles();
  };
  if (std::ranges::any_of(templates, is_same)) return {};
  return fail(study.string(),
              "is of the template " + known + ", which has other faces than " + of_them + "; " + remedy);
}

}  // namespace homolog
