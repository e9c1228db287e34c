#include "core/adapt/image/image_target.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

constexpr double last_reach_share = 0.3;  ///< share of the reach at the last step
constexpr double least_clear = 0.15,
                 clear_enough = 0.5;      ///< confidence of an edge that is none, and of one that counts
constexpr double most_beyond_others = 3;  ///< times as clear as those around it counts an edge at most
constexpr double pin_slope = 0.7;         ///< a mm away from a pin the boundary may lie so far off the mesh
constexpr double pin_tolerance_mm = 2;

/// The weight of an edge: nothing where it is hardly one, and little where those around it are none. A single vertex
/// with an edge would be drawn out to a spur.
VertexScalars supported(const Topology& topology, const VertexScalars& clearness) {
  const Eigen::ArrayXd share = ((clearness.array() - least_clear) / (clear_enough - least_clear)).max(0).min(1);
  const VertexScalars clear = clearness.array() * share.square() * (3 - 2 * share);
  VertexScalars counts = clear;
  for (Eigen::Index i = 0; i < clear.size(); ++i) {
    if (clear[i] <= 0) continue;
    const auto ring = topology.one_ring(i);
    double around = 0;
    for (const std::int32_t j : ring) around += clear[j];
    counts[i] =
        std::min(clear[i], most_beyond_others * around / static_cast<double>(std::max<std::size_t>(1, ring.size())));
  }
  return counts;
}

/// Around a pin the surface is known: edges far off the mesh count less the nearer they are to it.
void mind_pins(const Mesh& mesh, const std::vector<Pin>& pins, TargetPull& pull) {
  for (const Pin& pin : pins) {
    const Eigen::VectorXd away = (mesh.points.rowwise() - pin.place.transpose()).rowwise().norm();
    const Eigen::VectorXd shift = (pull.targets - mesh.points).rowwise().norm();
    const Eigen::ArrayXd off = shift.array() / (pin_tolerance_mm + pin_slope * away.array());
    pull.weights.array() *= (-0.5 * off.square()).exp();
  }
}

}  // namespace

ImageTarget::ImageTarget(const Volume& image, int frame, const Mesh& start, const EdgeOptions& options,
                         std::vector<Pin> pins)
    : edges_(image, frame, start, options), pins_(std::move(pins)), size_mm_(std::sqrt(surface_area_mm2(start))) {}

double ImageTarget::reach_mm(double share) const {
  return edges_.reach_mm() * (1 + share * (last_reach_share - 1));
}

TargetPull ImageTarget::nearest(const Mesh& mesh) {
  return edges_.find(mesh, last_reach_share * edges_.reach_mm());
}

TargetPull ImageTarget::pull(const Mesh& mesh, double share) {
  TargetPull pull = likeliest(mesh, share);
  pull.weights = supported(*mesh.topology, pull.weights);
  mind_pins(mesh, pins_, pull);
  return pull;
}

}  // namespace homolog
