#include "core/adapt/allowed_shapes.h"

#include <cmath>

#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

constexpr int allowed_steps = 40;
constexpr double first_noise_share = 0.05;  ///< share of the extent
constexpr double last_noise_edges = 0.4;    ///< about what a model of ten shapes leaves of a new one

}  // namespace

std::shared_ptr<const Template> mean_template(const Template& the_template, const AllowedShapes& allowed) {
  auto mean = std::make_shared<Template>(the_template);
  mean->landmarks = carried_landmarks(the_template, allowed.mean);
  mean->points = allowed.mean;
  return mean;
}

Result<AllowedFit> fit_allowed(const AllowedShapes& allowed, const std::shared_ptr<const Topology>& topology,
                               Similarity placement, const ForceSource& force, const AfterStep& after_step) {
  AllowedFit fit{placement.apply(allowed.mean), allowed.mean, placement};
  const double first_mm = first_noise_share * bounds_of(fit.points).diagonal().norm();
  const double last_mm = last_noise_edges * mean_edge_mm(*topology, fit.points);
  for (int step = 0; step < allowed_steps; ++step) {
    const double share = static_cast<double>(step) / (allowed_steps - 1);
    const Mesh mesh{topology, fit.points};
    const Force pull = force(mesh, share);
    // A weight of 1 is that of a vertex of which nothing is known.
    VertexScalars weights = (pull.weights.array() - 1).max(0);
    if (const double most = weights.maxCoeff(); most > 0) weights /= most;
    const Points targets = pull.weights.cwiseInverse().asDiagonal() * pull.pulls;
    const Similarity back = fit.placement.inverse();
    const Points normals = vertex_normals(mesh) * back.rotation.toRotationMatrix().transpose();
    const double noise_mm = first_mm * std::pow(last_mm / first_mm, share);
    const AllowedShape found = allowed.nearest(back.apply(targets), normals, weights, back.scale * noise_mm);
    const Points posed = fit.placement.apply(found.posed);
    fit.shape = found.shape;
    fit.placement = nearest_similarity(fit.shape, posed, fit.placement);
    fit.points = fit.placement.apply(fit.shape);
    if (!after_step) continue;
    if (auto done = after_step(share); !done) return fail(done.error());
  }
  return fit;
}

}  // namespace homolog
