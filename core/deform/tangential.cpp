#include "core/deform/tangential.h"

#include "core/deform/surface_walk.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/parts/rims.h"

namespace homolog {

Points tangential(const Mesh& mesh, const Points& offset) {
  const Topology& topology = *mesh.topology;
  const Points& points = mesh.points;
  const Points normals = vertex_normals(mesh);
  Points along = offset;
  for (Eigen::Index i = 0; i < offset.rows(); ++i) {
    const Eigen::RowVector3d n = normals.row(i);
    along.row(i) -= along.row(i).dot(n) * n;
  }
  for (const auto& loop : topology.rims()) {
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const auto before = loop[(k + loop.size() - 1) % loop.size()], after = loop[(k + 1) % loop.size()];
      const Eigen::RowVector3d direction = (points.row(after) - points.row(before)).stableNormalized();
      along.row(loop[k]) = offset.row(loop[k]).dot(direction) * direction;
    }
  }
  return along;
}

Points on_rims(const Mesh& mesh, const Points& points) {
  Points brought = points;
  for (const auto& loop : mesh.topology->rims())
    for (const std::int32_t i : loop)
      if (points.row(i) != mesh.points.row(i))
        brought.row(i) = nearest_on_rims({loop}, mesh.points, points.row(i).transpose()).position.transpose();
  return brought;
}

Points slid_along_surface(const Mesh& mesh, const Points& offset) {
  const Topology& topology = *mesh.topology;
  const Points& points = mesh.points;
  Points slid = points;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    if (topology.on_rim(i) || offset.row(i).squaredNorm() < 1e-18) continue;
    SurfacePoint from;
    from.face = topology.faces_of(i).front();
    slid.row(i) = walk_to_nearest(topology, points, from, (points.row(i) + offset.row(i)).transpose()).position;
  }
  for (const auto& loop : topology.rims())
    for (const std::int32_t i : loop)
      if (offset.row(i).squaredNorm() >= 1e-18) slid.row(i) += offset.row(i);
  return on_rims(mesh, slid);
}

}  // namespace homolog
