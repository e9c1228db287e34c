#include "core/adapt/fit.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/adapt/annealing.h"
#include "core/adapt/boundary/boundary_search.h"
#include "core/adapt/boundary/boundary_warp.h"
#include "core/adapt/untangle.h"
#include "core/deform/fold_guard.h"
#include "core/deform/gesture.h"
#include "core/deform/tangential.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/surface_search.h"
#include "core/placement/similarity_fit.h"

namespace homolog {

namespace {

constexpr Annealing annealing{.steps = 16, .softest_edges = 1};
constexpr int settling_steps = 3;
constexpr double easing_edges = 1;      ///< mean edges: folds of the template finer than about this are eased
constexpr double landmark_weight = 10;  ///< of a named place against a vertex on the boundary
constexpr double trusted = 0.5;         ///< a landmark below is called a blunder

class Fitting {
 public:
  Fitting(const Template& the_template, const Boundary& boundary, const FitOptions& options)
      : reference_(the_template),
        boundary_(boundary),
        options_(options),
        search_(boundary, the_template.points.rows()),
        solver_(the_template.topology) {
    shape_.factors = the_template.stiffness / the_template.stiffness.mean();
  }

  Result<FitResult> run() {
    if (auto placed = place(); !placed) return fail(placed.error());
    if (options_.allowed) return among_allowed();
    if (auto done = adapt(); !done) return fail(done.error());
    if (auto done = settle(); !done) return fail(done.error());
    return finish();
  }

 private:
  /// First the nearest of the allowed shapes; what follows keeps to that.
  Result<FitResult> among_allowed() {
    const auto forces = [this](const Mesh& mesh, double) {
      shape_.mesh = mesh;
      return force(mesh);
    };
    const auto after_step = [this](double share) { return show(0.1 + 0.4 * share); };
    const auto found = fit_allowed(*options_.allowed, reference_.topology, shape_.placement, forces, after_step);
    if (!found) return fail(found.error());
    shape_.mesh.points = found->points;
    shape_.placement = found->placement;
    shape_.rest = start_ = found->shape;
    shape_.refit();
    const double beyond = options_.allowed->beyond;
    if (beyond > 0) {
      if (auto done = anneal_to_boundary(); !done) return fail(done.error());
      if (auto done = settle(); !done) return fail(done.error());
    }
    if (beyond < 1) {
      shape_.mesh.points = found->points + beyond * (shape_.mesh.points - found->points);
      shape_.refit();
      if (beyond > 0) untangle(shape_.mesh, shape_.placed, shape_.factors);
    }
    FitResult result = finish();
    result.allowed = found->points;
    return result;
  }

  Result<void> place() {
    const auto [own, there] = matched_landmarks(reference_, options_.landmarks);
    if (options_.placement) {
      const Points placed = options_.placement->apply(reference_.points);
      if (!bounds_of(placed).intersects(bounds_of(boundary_.surface.points)))
        return fail(
            "",
            "the placement puts the template beside the organ; correct it, or leave it out to let the fit find one");
    }
    const Placed found =
        find_placement(reference_, boundary_, {options_.landmarks, options_.orientation, options_.placement});
    shape_.placement = found.placement;
    trust_ = found.trust.size() == own.rows() ? found.trust : VertexScalars::Ones(own.rows());
    say_of_landmarks((shape_.placement.apply(own) - there).rowwise().norm());
    const Points placed = shape_.placement.apply(reference_.points);
    if (options_.allowed) {
      shape_.mesh = {reference_.topology, placed};
      return show(0.1);
    }
    shape_.mesh = {reference_.topology,
                   warp_to_boundary(reference_.topology, placed, shape_.placement.apply(own), there, trust_, search_)};
    if (!shape_.mesh.points.allFinite() || !(shape_.placement.scale > 0))
      return fail("", "the template cannot be placed on the surface: one of them is flat or has no size; check both");
    start_ = shape_.placement.inverse().apply(shape_.mesh.points);
    return show(0.1);
  }

  /// `off_mm`: how far each given landmark lies from where the placement has it.
  void say_of_landmarks(const VertexScalars& off_mm) {
    if (trust_.size() > 0 && trust_.size() < fewest_placing_landmarks)
      landmark_warnings_.emplace_back(
          trust_.size() == 1 ? "one landmark pulls on the mesh but did not help to place it; give three or more"
                             : "two landmarks pull on the mesh but did not help to place it; give three or more");
    Eigen::Index k = -1;
    for (const Landmark& landmark : reference_.landmarks) {
      if (!options_.landmarks.contains(landmark.name) || trust_[++k] >= trusted) continue;
      char mm[32];
      std::snprintf(mm, sizeof mm, "%.0f mm", off_mm[k]);
      landmark_warnings_.push_back("the landmark \"" + landmark.name + "\" lies " + mm +
                                   " from where the surface and the other landmarks put it, so it was not used; check "
                                   "its place and name");
    }
  }

  /// To the boundary, from a reference that is eased.
  Result<void> adapt() {
    if (auto done = ease(); !done) return done;
    shape_.refit();
    return anneal_to_boundary();
  }

  Result<void> anneal_to_boundary() {
    return anneal(
        shape_, solver_, annealing, [this](const Mesh& mesh, double) { return force(mesh); },
        [this](double share) { return show(0.1 + 0.7 * share); });
  }

  /// Smooths the reference that the annealing keeps to. A deep fold that the case does not have would stay behind:
  /// its walls face each other, and neither finds the boundary. The folds that a case has come from its boundary.
  Result<void> ease() {
    const double edge_mm = mean_edge_mm(*reference_.topology, start_);
    const double stiffness = stiffness_from_length(easing_edges * edge_mm, edge_mm);
    if (auto ready = solver_.factorise(VertexScalars::Constant(shape_.factors.size(), stiffness)); !ready) return ready;
    const Points smooth = solver_.solve(start_);
    shape_.rest = nearest_similarity(smooth, start_, {}).apply(smooth);
    return {};
  }

  /// The pull of the boundary, in both directions, and that of the landmarks.
  Force force(const Mesh& mesh) {
    BoundaryPull pull = search_.pull(mesh);
    pull_landmarks(mesh, pull);
    const VertexScalars weights = pull.weights.cwiseMax(least_weight) / least_weight;
    return {weights, weights.asDiagonal() * pull.targets};
  }

  /// Adds the named places that the organ's landmarks pull on.
  void pull_landmarks(const Mesh& mesh, BoundaryPull& pull) const {
    Eigen::Index known = 0;
    for (std::size_t k = 0; k < reference_.landmarks.size(); ++k) {
      const auto there = options_.landmarks.find(reference_.landmarks[k].name);
      if (there == options_.landmarks.end()) continue;
      const double trust = trust_[known++];
      const Eigen::RowVector3d offset = (there->second - carried_landmark(reference_, k, mesh.points)).transpose();
      const auto corners = mesh.topology->triangles().row(reference_.landmark_points[k].face);
      for (int c = 0; c < 3; ++c) {
        const Eigen::Index i = corners[c];
        const double weight = landmark_weight * trust * reference_.landmark_points[k].weights[c],
                     total = pull.weights[i] + weight;
        if (total <= 0) continue;
        pull.targets.row(i) = (pull.weights[i] * pull.targets.row(i) + weight * (mesh.points.row(i) + offset)) / total;
        pull.weights[i] = total;
      }
    }
  }

  /// Vertices onto the boundary, evenly spread as in the reference.
  Result<void> settle() {
    Mesh& mesh = shape_.mesh;
    shape_.rest = start_;
    if (auto ready = solver_.factorise(shape_.factors); !ready) return ready;
    for (int step = 0; step < settling_steps; ++step) {
      shape_.refit();
      const FoldGuard guard(*mesh.topology, shape_.placed, mesh.points);
      const Points offset = tangential(mesh, relaxation_offset(*mesh.topology, solver_, shape_.placed, mesh.points));
      const auto slid = [&](double share) { return Points(mesh.points + share * offset); };
      mesh.points = slid(guard.accepted_step(1, slid));
      mesh.points = search_.nearest(mesh).targets;
      if (auto shown = show(0.8 + 0.1 * step / settling_steps); !shown) return shown;
    }
    shape_.refit();
    untangle(mesh, shape_.placed, shape_.factors);
    return show(0.95);
  }

  FitResult finish() {
    Mesh& mesh = shape_.mesh;
    FitResult result;
    result.placement = nearest_similarity(reference_.points, mesh.points, shape_.placement);
    result.turned_triangles =
        turned_triangles(*mesh.topology, result.placement.apply(reference_.points), mesh.points).size();
    result.self_intersections = self_intersections(mesh).size();
    for (Eigen::Index i = 0; i < mesh.points.rows(); ++i)
      if (!boundary_.shows(mesh.points.row(i))) result.unseen.push_back(static_cast<std::int32_t>(i));
    result.landmarks = carried_landmarks(reference_, mesh.points);
    result.landmarks_used = static_cast<std::size_t>((trust_.array() >= trusted).count());
    result.landmarks_place = result.landmarks_used >= static_cast<std::size_t>(fewest_placing_landmarks);
    result.warnings = std::move(landmark_warnings_);
    result.mesh = std::move(mesh);
    return result;
  }

  Result<void> show(double fraction) {
    if (options_.show) options_.show(shape_.mesh.points);
    if (options_.progress == nullptr) return {};
    options_.progress->report(fraction);
    return options_.progress->cancelled() ? Result<void>(fail("", "the fit was cancelled")) : Result<void>{};
  }

  const Template& reference_;
  const Boundary& boundary_;
  const FitOptions& options_;
  BoundarySearch search_;
  ShapeSolver solver_;
  Adapting shape_;       ///< its reference is `start_`, eased while the mesh anneals
  Points start_;         ///< the template, warped where landmarks ask for it
  VertexScalars trust_;  ///< of each landmark that was given
  std::vector<std::string> landmark_warnings_;
};

}  // namespace

Result<FitResult> fit_to_boundary(const Template& the_template, const Boundary& boundary, const FitOptions& options) {
  if (!options.allowed) return Fitting(the_template, boundary, options).run();
  const auto mean = mean_template(the_template, *options.allowed);
  auto fit = Fitting(*mean, boundary, options).run();
  if (fit) fit->placement = nearest_similarity(the_template.points, fit->mesh.points, fit->placement);
  return fit;
}

}  // namespace homolog
