#include "core/fit/mask_fit.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/deform/fold_guard.h"
#include "core/deform/gesture.h"
#include "core/deform/local_rotations.h"
#include "core/deform/tangential.h"
#include "core/fit/boundary_pull.h"
#include "core/fit/boundary_warp.h"
#include "core/fit/untangle.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/surface_search.h"
#include "core/placement/similarity_fit.h"
#include "core/solve/shape_solver.h"

namespace homolog {

namespace {

constexpr int annealing_steps = 16;
constexpr int settling_steps = 3;
constexpr double stiffest_share = 0.3;  ///< of the organ's diagonal: the length stiffness carries an edit at first
constexpr double softest_edges = 1;     ///< and at last, in mean edges
constexpr double easing_edges = 1;      ///< mean edges: folds of the template finer than about this are eased
constexpr double landmark_weight = 10;  ///< of a named place against a vertex on the boundary
constexpr double trusted = 0.5;         ///< a landmark below is called a blunder
constexpr double least_weight = 0.01;   ///< of a force that is not known: the solver needs one

class Fitting {
 public:
  Fitting(const Template& reference, const Boundary& boundary, const FitOptions& options)
      : reference_(reference),
        boundary_(boundary),
        options_(options),
        search_(boundary, reference.points.rows()),
        solver_(reference.topology),
        factors_(reference.stiffness / reference.stiffness.mean()) {}

  Result<FitResult> run() {
    if (auto placed = place(); !placed) return fail(placed.error());
    if (auto done = anneal(); !done) return fail(done.error());
    if (auto done = settle(); !done) return fail(done.error());
    return finish();
  }

 private:
  Result<void> place() {
    const auto [own, there] = matched_landmarks(reference_, options_.landmarks);
    if (options_.placement) {
      const Points placed = options_.placement->apply(reference_.points);
      if (!bounds_of(placed).intersects(bounds_of(boundary_.surface.points)))
        return fail("", "the placement puts the template where the organ is not; leave it out, and the fit finds one");
    }
    const Placed found =
        find_placement(reference_, boundary_, {options_.landmarks, options_.orientation, options_.placement});
    placement_ = found.placement;
    trust_ = found.trust.size() == own.rows() ? found.trust : VertexScalars::Ones(own.rows());
    say_of_landmarks((placement_.apply(own) - there).rowwise().norm());
    const Points placed = placement_.apply(reference_.points);
    mesh_ = {reference_.topology,
             warp_to_boundary(reference_.topology, placed, placement_.apply(own), there, trust_, search_)};
    start_ = placement_.inverse().apply(mesh_.points);
    return show(0.1);
  }

  /// `off_mm`: how far each given landmark lies from where the placement has it.
  void say_of_landmarks(const VertexScalars& off_mm) {
    if (trust_.size() > 0 && trust_.size() < fewest_placing_landmarks)
      landmark_warnings_.emplace_back(
          trust_.size() == 1 ? "one landmark pulls on the mesh and did not help to place it; three or more do"
                             : "two landmarks pull on the mesh and did not help to place it; three or more do");
    Eigen::Index k = -1;
    for (const Landmark& landmark : reference_.landmarks) {
      if (!options_.landmarks.contains(landmark.name) || trust_[++k] >= trusted) continue;
      char mm[32];
      std::snprintf(mm, sizeof mm, "%.0f mm", off_mm[k]);
      landmark_warnings_.push_back("the landmark \"" + landmark.name + "\" lies " + mm +
                                   " from where the surface and the other landmarks have it, and was left aside; check "
                                   "its place and name");
    }
  }

  Result<void> anneal() {
    const double edge_mm = mean_edge_mm(*mesh_.topology, mesh_.points);
    const double first_mm = stiffest_share * bounds_of(mesh_.points).diagonal().norm();
    const double last_mm = softest_edges * edge_mm;
    if (auto done = ease(); !done) return done;
    for (int step = 0; step < annealing_steps; ++step) {
      const double share = static_cast<double>(step) / (annealing_steps - 1);
      const double length_mm = first_mm * std::pow(last_mm / first_mm, share);
      if (auto done = solve(stiffness_from_length(length_mm, edge_mm)); !done) return done;
      if (auto shown = show(0.1 + 0.7 * share); !shown) return shown;
    }
    return {};
  }

  /// Smooths the reference that the annealing keeps to. A deep fold that the case does not have would stay behind:
  /// its walls face each other, and neither finds the boundary. The folds that a case has come from its boundary.
  Result<void> ease() {
    const double edge_mm = mean_edge_mm(*reference_.topology, start_);
    const double stiffness = stiffness_from_length(easing_edges * edge_mm, edge_mm);
    if (auto ready = solver_.factorise(VertexScalars::Constant(factors_.size(), stiffness)); !ready) return ready;
    const Points smooth = solver_.solve(start_);
    rest_ = fit_similarity(smooth, start_, {}).apply(smooth);
    return {};
  }

  /// Eq. 3 with the boundary's force targets and a reference that turns with the shape, each force times its weight.
  Result<void> solve(double stiffness) {
    refit();
    BoundaryPull pull = search_.pull(mesh_);
    pull_landmarks(pull);
    const VertexScalars weights = pull.weights.cwiseMax(least_weight) / least_weight;
    const VertexScalars w = stiffness / least_weight * factors_;
    if (auto ready = solver_.factorise(w, (weights.array() - 1).matrix()); !ready) return ready;
    mesh_.points =
        solver_.solve(Points(weights.asDiagonal() * pull.targets +
                             rotated_reference_force(*mesh_.topology, w, placed_,
                                                     fit_local_rotations(*mesh_.topology, placed_, mesh_.points))));
    return {};
  }

  /// Adds the named places that the organ's landmarks pull on.
  void pull_landmarks(BoundaryPull& pull) const {
    Eigen::Index known = 0;
    for (std::size_t k = 0; k < reference_.landmarks.size(); ++k) {
      const auto there = options_.landmarks.find(reference_.landmarks[k].name);
      if (there == options_.landmarks.end()) continue;
      const double trust = trust_[known++];
      const Eigen::RowVector3d offset = (there->second - carried_landmark(reference_, k, mesh_.points)).transpose();
      const auto corners = mesh_.topology->triangles().row(reference_.landmark_points[k].face);
      for (int c = 0; c < 3; ++c) {
        const Eigen::Index i = corners[c];
        const double weight = landmark_weight * trust * reference_.landmark_points[k].weights[c],
                     total = pull.weights[i] + weight;
        if (total <= 0) continue;
        pull.targets.row(i) = (pull.weights[i] * pull.targets.row(i) + weight * (mesh_.points.row(i) + offset)) / total;
        pull.weights[i] = total;
      }
    }
  }

  void refit() {
    placement_ = fit_similarity(rest_, mesh_.points, placement_);
    placed_ = placement_.apply(rest_);
  }

  /// Vertices onto the boundary, evenly spread as in the reference.
  Result<void> settle() {
    rest_ = start_;
    if (auto ready = solver_.factorise(factors_); !ready) return ready;
    for (int step = 0; step < settling_steps; ++step) {
      refit();
      const FoldGuard guard(*mesh_.topology, placed_, mesh_.points);
      const Points offset = tangential(mesh_, relaxation_offset(*mesh_.topology, solver_, placed_, mesh_.points));
      const auto slid = [&](double share) { return Points(mesh_.points + share * offset); };
      mesh_.points = slid(guard.accepted_step(1, slid));
      mesh_.points = search_.nearest(mesh_).targets;
      if (auto shown = show(0.8 + 0.1 * step / settling_steps); !shown) return shown;
    }
    refit();
    untangle(mesh_, placed_, factors_);
    return show(0.95);
  }

  Result<FitResult> finish() {
    FitResult result;
    result.placement = fit_similarity(reference_.points, mesh_.points, placement_);
    result.turned_triangles =
        turned_triangles(*mesh_.topology, result.placement.apply(reference_.points), mesh_.points).size();
    result.self_intersections = self_intersections(mesh_).size();
    for (Eigen::Index i = 0; i < mesh_.points.rows(); ++i)
      if (!boundary_.shows(mesh_.points.row(i))) result.unseen.push_back(static_cast<std::int32_t>(i));
    result.landmarks = carried_landmarks(reference_, mesh_.points);
    result.landmarks_used = static_cast<std::size_t>((trust_.array() >= trusted).count());
    result.landmarks_place = result.landmarks_used >= static_cast<std::size_t>(fewest_placing_landmarks);
    result.warnings = std::move(landmark_warnings_);
    result.mesh = std::move(mesh_);
    return result;
  }

  Result<void> show(double fraction) {
    if (options_.show) options_.show(mesh_.points);
    if (options_.progress == nullptr) return {};
    options_.progress->report(fraction);
    return options_.progress->cancelled() ? Result<void>(fail("", "the fit was cancelled")) : Result<void>{};
  }

  const Template& reference_;
  const Boundary& boundary_;
  const FitOptions& options_;
  BoundarySearch search_;
  ShapeSolver solver_;
  VertexScalars factors_;
  Points start_;  ///< the template, warped where landmarks ask for it
  Points rest_;   ///< R unplaced: `start_`, eased while the mesh anneals
  Similarity placement_;
  VertexScalars trust_;  ///< of each landmark that was given
  std::vector<std::string> landmark_warnings_;
  Points placed_;  ///< R: rest_ under placement_
  Mesh mesh_;
};

}  // namespace

Result<FitResult> fit_to_boundary(const Template& reference, const Boundary& boundary, const FitOptions& options) {
  return Fitting(reference, boundary, options).run();
}

}  // namespace homolog
