#include "core/experiment/sight.h"

#include "core/base/numbers/statistics.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

// A fine mask has far more vertices than a person looks at.
constexpr Eigen::Index looked_at = 2500;

}  // namespace

double mean_mm(const std::vector<Deviation>& deviations) {
  return mean_of(deviations, &Deviation::distance_mm);
}

double mean_square_mm2(const std::vector<Deviation>& deviations) {
  return mean_of(deviations, [](const Deviation& d) { return d.distance_mm * d.distance_mm; });
}

Sight::Sight(const Mesh& target, std::shared_ptr<const Topology> topology)
    : target_(target), topology_(std::move(topology)) {
  const Points& there = target.points;
  const Eigen::Index stride = 1 + there.rows() / looked_at;
  for (Eigen::Index i = 0; i < there.rows(); i += stride) places_.push_back(there.row(i));
  target_faces_.resize(static_cast<std::size_t>(topology_->vertices()));
  own_faces_.resize(places_.size());
}

Points Sight::with_cap_centres(const Points& points) const {
  const auto& loops = topology_->rims();
  Points all(points.rows() + static_cast<Eigen::Index>(loops.size()), 3);
  all.topRows(points.rows()) = points;
  for (std::size_t k = 0; k < loops.size(); ++k)
    all.row(points.rows() + static_cast<Eigen::Index>(k)) = points(loops[k], Eigen::all).colwise().mean();
  return all;
}

Deviation Sight::to_target(const Points& points, std::int32_t vertex) {
  std::int32_t& likely_face = target_faces_[vertex];
  const auto nearest = target_.nearest(points.row(vertex), likely_face);
  likely_face = nearest.at.face;
  return {points.row(vertex), nearest.position, nearest.distance_mm, vertex};
}

Deviation Sight::to_mesh(const Vec3& place, const Points& points, std::int32_t& likely_face) const {
  const auto nearest = own_->nearest(place, likely_face);
  likely_face = nearest.at.face;
  const auto corners = capped_topology_->triangles().row(nearest.at.face);
  if (nearest.at.face < topology_->triangles().rows()) {
    Eigen::Index nearest_corner = 0;
    nearest.at.weights.maxCoeff(&nearest_corner);
    return {nearest.position, place, nearest.distance_mm, corners[nearest_corner]};
  }
  // A cap cannot be grabbed: its rim is, and goes where the cap should go.
  const std::int32_t rim = corners.minCoeff();
  const Vec3 at = points.row(rim);
  return {at, at + place - nearest.position, nearest.distance_mm, rim};
}

std::vector<Deviation> Sight::look(const Points& points) {
  if (!own_) {
    const Mesh closed = capped({topology_, points});
    capped_topology_ = closed.topology;
    own_ = std::make_unique<SurfaceSearch>(closed);
  } else {
    own_->refit(with_cap_centres(points));
  }
  std::vector<Deviation> found;
  found.reserve(static_cast<std::size_t>(points.rows()) + places_.size());
  for (Eigen::Index i = 0; i < points.rows(); ++i) found.push_back(to_target(points, static_cast<std::int32_t>(i)));
  for (std::size_t k = 0; k < places_.size(); ++k) found.push_back(to_mesh(places_[k], points, own_faces_[k]));
  return found;
}

}  // namespace homolog
