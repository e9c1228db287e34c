#include "core/model/measures/groups.h"

#include <cassert>

#include "core/mesh/mesh_quality.h"

namespace homolog {

Points group_difference_mm(const PrincipalComponents& components, const std::vector<Eigen::Index>& from,
                           const std::vector<Eigen::Index>& to) {
  assert(!from.empty() && !to.empty());
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(components.shapes());
  for (const Eigen::Index shape : from) weights[shape] -= 1 / static_cast<double>(from.size());
  for (const Eigen::Index shape : to) weights[shape] += 1 / static_cast<double>(to.size());
  return points_of(Eigen::VectorXd(components.centred * weights));
}

VertexScalars outward_mm(const Mesh& shape, const Points& offset_mm) {
  if (!shape.topology) return offset_mm.rowwise().norm();
  return offset_mm.cwiseProduct(vertex_normals(shape)).rowwise().sum();
}

}  // namespace homolog
