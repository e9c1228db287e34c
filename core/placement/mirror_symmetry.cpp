#include "core/placement/mirror_symmetry.h"

#include <cmath>
#include <vector>

#include "core/base/numbers/rotation.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

constexpr Eigen::Index samples = 800;
constexpr int rounds = 40;
constexpr double same_way = 0.4;      ///< cosine between normals of places that may be counterparts
constexpr double most_off = 0.015;    ///< share of the root of the area, root mean square
constexpr double fewest_pairs = 0.5;  ///< share of the samples

}  // namespace

Reflection sagittal_reflection(const Points& points) {
  const Vec3 centre = points.colwise().mean();
  const Mat3 flip = Vec3(-1, 1, 1).asDiagonal();
  return {flip, centre - flip * centre};
}

Reflection carried_by(const Similarity& similarity, const Reflection& reflection) {
  const Mat3 rotation = similarity.rotation.toRotationMatrix(),
             turn = rotation * reflection.turn * rotation.transpose();
  return {turn, similarity.apply(reflection.shift) - turn * similarity.translation};
}

std::optional<Reflection> mirror_symmetry(const SurfaceSearch& surface, const Reflection& start) {
  const Mesh& mesh = surface.mesh();
  const Points normals = vertex_normals(mesh);
  const double size_mm = std::sqrt(surface_area_mm2(mesh));
  const Mat3 flip = Vec3(-1, 1, 1).asDiagonal();  // any reflection is this, turned
  Reflection found = start;
  const Eigen::Index stride = 1 + mesh.points.rows() / samples, most = 1 + mesh.points.rows() / stride;
  std::vector<std::int32_t> likely(static_cast<std::size_t>(most), 0);
  for (int round = 0; round < rounds; ++round) {
    Points from(most, 3), to(most, 3);
    Eigen::Index pairs = 0, looked_at = 0;
    double squares_mm2 = 0;
    for (Eigen::Index i = 0; i < mesh.points.rows(); i += stride) {
      std::int32_t& face = likely[looked_at++];
      const auto nearest = surface.nearest(found.apply(mesh.points.row(i)), face);
      face = nearest.at.face;
      squares_mm2 += nearest.distance_mm * nearest.distance_mm;
      const Eigen::RowVector3d facing = nearest.at.interpolate(*mesh.topology, normals);
      if (facing * (found.turn * normals.row(i).transpose()) < same_way) continue;
      from.row(pairs) = mesh.points.row(i);
      to.row(pairs++) = nearest.position.transpose();
    }
    const double off_mm = std::sqrt(squares_mm2 / static_cast<double>(looked_at));
    const bool paired = static_cast<double>(pairs) >= fewest_pairs * static_cast<double>(looked_at);
    if (!paired || !std::isfinite(off_mm)) return std::nullopt;
    if (round + 1 == rounds && off_mm > most_off * size_mm) return std::nullopt;
    from.conservativeResize(pairs, Eigen::NoChange);
    to.conservativeResize(pairs, Eigen::NoChange);
    const Eigen::RowVector3d from_mean = from.colwise().mean(), to_mean = to.colwise().mean();
    const Points flipped = (from.rowwise() - from_mean) * flip;
    found.turn = nearest_rotation((to.rowwise() - to_mean).transpose() * flipped) * flip;
    found.shift = to_mean.transpose() - found.turn * from_mean.transpose();
  }
  return found;
}

}  // namespace homolog
