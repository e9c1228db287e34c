#include "core/model/alignment/self_mirror.h"

#include <cmath>

#include "core/mesh/mesh_quality.h"
#include "core/placement/mirror_symmetry.h"

namespace homolog {

namespace {

/// A place on the surface as it curves between the vertices: half the way to the tangent planes of the face's corners,
/// which is exact where it curves evenly. On the flat faces every mirror image would be a little thinner than its
/// shape.
Eigen::RowVector3d curved_place(const SurfacePoint& at, const Topology& topology, const Points& shape,
                                const Points& normals) {
  const Eigen::RowVector3d flat = at.interpolate(topology, shape);
  Eigen::RowVector3d place = flat;
  for (int c = 0; c < 3; ++c) {
    const std::int32_t corner = topology.triangles()(at.face, c);
    const Eigen::RowVector3d normal = normals.row(corner);
    place += at.weights[c] / 2 * (shape.row(corner) - flat).dot(normal) * normal;
  }
  return place;
}

}  // namespace

Result<SelfMirror> self_mirror(const Mesh& mean) {
  const SurfaceSearch search(mean);
  const auto found = mirror_symmetry(search, sagittal_reflection(mean.points));
  if (!found)
    return fail(
        "",
        "is not symmetric in itself across a sagittal plane: the mean shape stays off its mirror image; compare "
        "left with right organs by --flip-mirrored and --paired instead");
  SelfMirror mirror{mean.topology, {}, 0};
  std::int32_t likely = 0;
  for (Eigen::Index v = 0; v < mean.points.rows(); ++v) {
    const auto nearest = search.nearest(found->apply(mean.points.row(v)), likely);
    likely = nearest.at.face;
    mirror.counterparts.push_back(nearest.at);
    mirror.off_mm += nearest.distance_mm * nearest.distance_mm;
  }
  mirror.off_mm = std::sqrt(mirror.off_mm / static_cast<double>(mean.points.rows()));
  return mirror;
}

Points mirrored_in_itself(const SelfMirror& mirror, const Points& shape) {
  const Points normals = vertex_normals({mirror.topology, shape});
  Points image(shape.rows(), 3);
  for (Eigen::Index v = 0; v < shape.rows(); ++v)
    image.row(v) = curved_place(mirror.counterparts[v], *mirror.topology, shape, normals);
  image.col(0) *= -1;
  return image;
}

}  // namespace homolog
