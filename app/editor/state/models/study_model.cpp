#include "app/editor/state/models/study_model.h"

#include <algorithm>

#include "core/mesh/mesh_quality.h"
#include "core/model/measures/groups.h"

namespace homolog {

std::ptrdiff_t StudyModel::index_of(const std::string& name) const {
  const auto found = places.find(name);
  return found == places.end() ? -1 : static_cast<std::ptrdiff_t>(found->second);
}

Points StudyModel::shape(std::size_t k) const {
  const Eigen::VectorXd both = components->mean + components->centred.col(static_cast<Eigen::Index>(k));
  return points_of(both);
}

std::vector<std::string> StudyModel::comparable_groups() const {
  std::vector<std::string> found;
  for (const std::string& group : groups)
    if (!group.empty() && std::find(found.begin(), found.end(), group) == found.end() &&
        std::count(groups.begin(), groups.end(), group) > 1)
      found.push_back(group);
  return found;
}

std::vector<Eigen::Index> StudyModel::of_group(const std::string& group) const {
  std::vector<Eigen::Index> found;
  for (std::size_t k = 0; k < groups.size(); ++k)
    if (groups[k] == group) found.push_back(static_cast<Eigen::Index>(k));
  return found;
}

bool same_shape(const MeshFile& a, const MeshFile& b) {
  const auto same = [](const auto& one, const auto& other) { return one.rows() == other.rows() && one == other; };
  const auto confirmed = [](const MeshFile& file) {
    const auto found = file.arrays.find("confirmed");
    return found == file.arrays.end() ? VertexScalars() : found->second;
  };
  return same(a.points, b.points) && same(a.triangles, b.triangles) && a.landmarks == b.landmarks &&
         same(confirmed(a), confirmed(b));
}

VertexScalars difference_of_groups_mm(const StudyModel& model, const std::string& from, const std::string& to) {
  return outward_mm(model.mean, group_difference_mm(*model.components, model.of_group(from), model.of_group(to)));
}

}  // namespace homolog
