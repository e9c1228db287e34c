#include "core/snap/snap.h"

#include <algorithm>
#include <cmath>

#include "core/deform/local_rotations.h"
#include "core/fit/untangle.h"
#include "core/mesh/mesh_quality.h"
#include "core/placement/similarity_fit.h"
#include "core/solve/shape_solver.h"

namespace homolog {

namespace {

constexpr int snap_steps = 12;
constexpr double snap_stiffest_share = 0.3;  ///< of the mesh's diagonal: the length stiffness carries a force at first
constexpr double snap_softest_edges = 1.5;   ///< and at last, in mean edges
constexpr double snap_softest_edges_learned = 3;  ///< a case done before differs less: the shape is trusted more
constexpr double last_reach_share = 0.3;
constexpr double least_snap_weight = 0.01;  ///< of a vertex that nothing pulls: the solver needs a force
constexpr double held_weight = 1e4;         ///< of a held vertex against all that pulls at it; then it is set still
constexpr double least_seen_share = 0.1;
constexpr double doubtful_snap = 0.55;

bool image_shows(const VolumeGeometry& image, const Vec3& p_mm) {
  const Vec3 voxel = image.to_voxel(p_mm);
  const Vec3 last(image.dims[0] - 0.5, image.dims[1] - 0.5, image.dims[2] - 0.5);
  return (voxel.array() >= -0.5).all() && (voxel.array() <= last.array()).all();
}

/// Free vertices that the image does not show.
std::vector<std::int32_t> unseen_vertices(const VolumeGeometry& image, const Points& points,
                                          const VertexScalars& free) {
  std::vector<std::int32_t> unseen;
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    if (free[i] > 0 && !image_shows(image, points.row(i))) unseen.push_back(static_cast<std::int32_t>(i));
  return unseen;
}

class Snapping {
 public:
  Snapping(const Volume& image, int frame, const SnapStart& start, const SnapOptions& options)
      : grid_(image.geometry),
        start_(start),
        options_(options),
        edges_(image, frame, start.mesh, options.edges),
        solver_(start.mesh.topology),
        factors_(start.stiffness / start.stiffness.mean()),
        mesh_(start.mesh),
        reference_(start.mesh.points) {}

  Result<SnapResult> run() {
    if (!edges_.sees_edges())
      return fail("", "shows no edge around the mesh; place the mesh on the organ, or search farther");
    const double edge_mm = mean_edge_mm(*mesh_.topology, mesh_.points);
    const double first_mm = snap_stiffest_share * bounds_of(mesh_.points).diagonal().norm();
    const double last_mm = (edges_.learned() ? snap_softest_edges_learned : snap_softest_edges) * edge_mm;
    for (int step = 0; step < snap_steps; ++step) {
      const double share = static_cast<double>(step) / (snap_steps - 1);
      const double length_mm = first_mm * std::pow(last_mm / first_mm, share);
      const double reach_mm = edges_.reach_mm() * (1 + share * (last_reach_share - 1));
      if (auto done = solve(stiffness_from_length(length_mm, edge_mm), edges_.find(mesh_, reach_mm)); !done)
        return fail(done.error());
      if (options_.progress == nullptr) continue;
      options_.progress->report(static_cast<double>(step + 1) / (snap_steps + 1));
      if (options_.progress->cancelled()) return fail("", "the snap was cancelled");
    }
    make_sound();
    return finish();
  }

 private:
  void solve_targets(const BoundaryPull& pull, VertexScalars& weights, Points& forces) const {
    for (Eigen::Index i = 0; i < weights.size(); ++i) {
      const double share = options_.strength * start_.free[i];
      const double towards = share * pull.weights[i], back = 1 - share;
      weights[i] = std::max(towards + back, least_snap_weight);
      forces.row(i) = towards * pull.targets.row(i) + back * start_.mesh.points.row(i) +
                      (weights[i] - towards - back) * mesh_.points.row(i);
    }
  }

  Result<void> solve(double stiffness, const BoundaryPull& pull) {
    const Topology& topology = *mesh_.topology;
    const VertexScalars w = stiffness / least_snap_weight * factors_;
    VertexScalars weights(w.size());
    Points forces(w.size(), 3);
    solve_targets(pull, weights, forces);
    weights /= least_snap_weight;
    forces /= least_snap_weight;
    for (Eigen::Index i = 0; i < w.size(); ++i) {
      if (start_.free[i] > 0) continue;
      double pulled = weights[i];
      for (const std::int32_t j : topology.one_ring(i)) pulled += w[i] + w[j];
      weights[i] = held_weight * pulled;
      forces.row(i) = weights[i] * start_.mesh.points.row(i);
    }
    if (auto ready = solver_.factorise(w, (weights.array() - 1).matrix()); !ready) return ready;
    const auto rotations = fit_local_rotations(topology, reference_, mesh_.points);
    mesh_.points = solver_.solve(Points(forces + rotated_reference_force(topology, w, reference_, rotations)));
    keep_held();
    similarity_ = fit_similarity(start_.mesh.points, mesh_.points, similarity_);
    reference_ = similarity_.apply(start_.mesh.points);
    return {};
  }

  void keep_held() {
    for (Eigen::Index i = 0; i < mesh_.points.rows(); ++i)
      if (!(start_.free[i] > 0)) mesh_.points.row(i) = start_.mesh.points.row(i);
  }

  /// Frees faces that meet or turn; where some turn still, other than those that did at the start, the way there is
  /// shortened.
  void make_sound() {
    untangle(mesh_, reference_, factors_);
    keep_held();
    mesh_.points = without_turning(*mesh_.topology, start_.placed, start_.mesh.points, mesh_.points);
  }

  SnapResult finish() const {
    SnapResult result;
    result.points = mesh_.points;
    result.confidence = edges_.find(mesh_, last_reach_share * edges_.reach_mm()).weights;
    result.unseen = unseen_vertices(grid_, mesh_.points, start_.free);
    VertexScalars seen = start_.free;
    for (const std::int32_t v : result.unseen) seen[v] = 0;
    if (seen.sum() > 0) result.mean_confidence = seen.dot(result.confidence) / seen.sum();
    result.moved_mm = start_.free.dot((mesh_.points - start_.mesh.points).rowwise().norm()) / start_.free.sum();
    result.doubtful = result.mean_confidence < doubtful_snap;
    if (result.doubtful)
      result.warnings.emplace_back(
          "the image shows hardly any boundary where the mesh lies; check that this is the organ and that the mesh "
          "lies on it");
    if (!result.unseen.empty())
      result.warnings.push_back(std::to_string(result.unseen.size()) +
                                " vertices lie beyond the scan and follow the others");
    return result;
  }

  const VolumeGeometry& grid_;
  const SnapStart& start_;
  const SnapOptions& options_;
  EdgeSearch edges_;
  ShapeSolver solver_;
  VertexScalars factors_;
  Mesh mesh_;
  Similarity similarity_;  ///< from P⁰ to the shape
  Points reference_;       ///< R: P⁰ under it
};

}  // namespace

Result<SnapResult> snap(const Volume& image, int frame, const SnapStart& start, const SnapOptions& options) {
  if (options.strength <= 0 || !start.free.any()) {
    SnapResult still;
    still.points = start.mesh.points;
    still.confidence = VertexScalars::Zero(start.mesh.points.rows());
    return still;
  }
  const auto unseen = unseen_vertices(image.geometry, start.mesh.points, start.free);
  const auto free = static_cast<double>((start.free.array() > 0).count());
  if (static_cast<double>(unseen.size()) > (1 - least_seen_share) * free)
    return fail("", "does not show the place where the mesh lies; place the mesh on the organ first");
  return Snapping(image, frame, start, options).run();
}

}  // namespace homolog
