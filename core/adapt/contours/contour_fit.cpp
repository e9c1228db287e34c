#include "core/adapt/contours/contour_fit.h"

#include <algorithm>
#include <cmath>

#include "core/adapt/boundary/landmark_pull.h"
#include "core/adapt/boundary/surface_target.h"
#include "core/adapt/contours/contour_target.h"
#include "core/adapt/contours/contour_warp.h"
#include "core/adapt/fit_doubt.h"
#include "core/adapt/untangle.h"
#include "core/base/numbers/statistics.h"
#include "core/deform/fold_guard.h"
#include "core/deform/local_rotations.h"
#include "core/mesh/mesh_quality.h"
#include "core/placement/landmark_warp.h"
#include "core/placement/likely_similarity.h"
#include "core/placement/similarity_fit.h"

namespace homolog {

namespace {

constexpr std::size_t contour_pieces = 400, rough_pieces = 200, most_pins = 120;
/// They begin softer than from a placement: the warp lies about right already. And they end softer: stiffer at the end,
/// the mesh would pass some tenths of a mm beside the curves.
constexpr Annealing onto_contours{.steps = 15, .softest_edges = 0.25, .stiffest_share = 0.1};
constexpr Annealing roughly_onto_contours{.steps = 6, .softest_edges = 0.25, .stiffest_share = 0.1};

/// Contours, and a surface where they say little: the less they say of a vertex, the more the surface counts there;
/// where they say much, it is silent.
class ContoursOnSurface : public Target {
 public:
  /// Both outlive this.
  ContoursOnSurface(ContourTarget& contours, SurfaceTarget& surface) : contours_(contours), surface_(surface) {}

  TargetPull pull(const Mesh& mesh, double share) override {
    TargetPull pull = contours_.pull(mesh, share);
    const TargetPull other = surface_.pull(mesh, share);
    const double much = 0.25 * pull.weights.maxCoeff();
    for (Eigen::Index i = 0; i < pull.weights.size(); ++i) {
      const double own = pull.weights[i], said = much > 0 ? std::min(1.0, own / much) : 0;
      const double free = (1 - said) * other.weights[i];
      if (!(own + free > 0)) continue;
      pull.targets.row(i) = (own * pull.targets.row(i) + free * other.targets.row(i)) / (own + free);
      pull.weights[i] = own + free;
    }
    return pull;
  }
  TargetPull nearest(const Mesh& mesh) override { return pull(mesh, 1); }
  double size_mm() const override { return contours_.size_mm(); }

 private:
  ContourTarget& contours_;
  SurfaceTarget& surface_;
};

/// Without the rims of holes where the mesh has no walls that these could belong to. `holes`: how many pieces were.
ContourSamples samples_for(const Topology& topology, const std::vector<DrawnContour>& contours, std::size_t pieces,
                           std::size_t& holes) {
  ContourSamples drawn = sampled_contours(contours, pieces);
  if (topology.genus() == 0) holes = std::erase_if(drawn.samples, [](const ContourSample& one) { return one.hole; });
  return drawn;
}

/// One template on its way to some curves.
class ContourFitting {
 public:
  ContourFitting(const Template& the_template, const std::vector<DrawnContour>& contours, const FitOptions& options)
      : template_(the_template),
        options_(options),
        target_(samples_for(*the_template.topology, contours, options.rough ? rough_pieces : contour_pieces, holes_)) {}

  Result<FitResult> alone() {
    if (auto usable = check(); !usable) return fail(usable.error());
    Placed placed;
    if (options_.stays && options_.placement)
      placed.placement = *options_.placement;
    else
      placed = find_placement(
          template_, target_.contours().likely(),
          {.landmarks = options_.landmarks, .orientation = options_.orientation, .start = options_.placement});
    placement_ = placed.placement;
    const Points points = placement_.apply(template_.points);
    if (auto shown = show(points, 0.2); !shown) return fail(shown.error());
    const auto [own, there] = matched_landmarks(template_, options_.landmarks);
    trust_ = placed.trust.size() == own.rows() ? placed.trust : VertexScalars(VertexScalars::Ones(own.rows()));
    const double landmark_mm = warp_lengths(bounds_of(points).diagonal().norm()).noise_mm;
    const ContourWarp warp =
        warp_to_contours(template_.topology, points, target_, placement_.apply(own), there, landmark_mm);
    if (!warp.points.allFinite()) return fail("", "has contours that no template can be placed on; check them");
    if (auto shown = show(warp.points, 0.6); !shown) return fail(shown.error());
    FitResult result;
    result.warnings =
        warnings_of_landmarks(template_, options_.landmarks, trust_, (placement_.apply(own) - there).rowwise().norm());
    auto drawn = draw(warp.points, target_);
    if (!drawn) return fail(drawn.error());
    if (options_.rough) {
      result.placement = placement_;
      result.mesh = std::move(*drawn);
      return result;
    }
    finish(std::move(*drawn), result);
    result.believed = believed_landmarks(template_, options_.landmarks, trust_);
    result.landmarks_used = result.believed.size();
    result.landmarks_place = result.landmarks_used >= static_cast<std::size_t>(fewest_placing_landmarks);
    const bool told = result.landmarks_place;
    result.doubt_mm = fit_doubt_mm(
        result.mesh,
        {.spread_mm2 = warp.deviation.cwiseAbs2(),
         .strain = strain_share(*template_.topology, placement_.apply(template_.points), result.mesh.points),
         .roundness = told ? 0 : roundness({template_.topology, template_.points}),
         .missing = {},
         .sliding = shares_of_sliding(result.mesh)});
    return result;
  }

  /// From a fit to a boundary.
  Result<FitResult> with(const Boundary& boundary, FitResult fit) {
    if (auto usable = check(); !usable) return fail(usable.error());
    placement_ = fit.placement;
    trust_ = VertexScalars::Ones(matched_landmarks(template_, options_.landmarks).first.rows());
    SurfaceTarget surface(boundary, template_.points.rows());
    ContoursOnSurface both(target_, surface);
    auto drawn = draw(fit.mesh.points, both);
    if (!drawn) return fail(drawn.error());
    finish(std::move(*drawn), fit);
    return fit;
  }

 private:
  Result<void> check() const {
    if (target_.contours().samples.empty() || !(target_.size_mm() > 0))
      return fail("", "has no contours of any extent to fit to; draw some");
    return {};
  }

  /// Draws a mesh that lies about right to a target, as a fit to a surface does [anneal]. What it keeps to is the mesh
  /// as it begins. The other steps of such a fit [FitSteps] would end on a surface, and curves are none.
  Result<Mesh> draw(const Points& from, Target& target) {
    Adapting shape{.mesh = {template_.topology, from},
                   .rest = from,
                   .placed = from,
                   .factors = template_.stiffness / template_.stiffness.mean()};
    ShapeSolver solver(template_.topology);
    const auto force = [&](const Mesh& mesh, double share) {
      TargetPull pull = target.pull(mesh, share);
      pull_landmarks(template_, options_.landmarks, trust_, mesh, pull);
      return force_of(pull);
    };
    const auto after_step = [&](double share) { return show(shape.mesh.points, 0.6 + 0.3 * share); };
    if (auto done = anneal(shape, solver, options_.rough ? roughly_onto_contours : onto_contours, force, after_step);
        !done)
      return fail(done.error());
    placement_ = nearest_similarity(template_.points, shape.mesh.points, placement_);
    if (!options_.rough) untangle(shape.mesh, placement_.apply(template_.points), shape.factors);
    return std::move(shape.mesh);
  }

  void finish(Mesh mesh, FitResult& result) const {
    const Points form = placement_.apply(template_.points);
    result.placement = placement_;
    result.turned_triangles = turned_triangles(*template_.topology, form, mesh.points).size();
    result.self_intersections = self_intersections(mesh).size();
    result.landmarks = carried_landmarks(template_, mesh.points);
    result.mesh = std::move(mesh);
    if (holes_ > 0)
      result.warnings.emplace_back(
          "some contours are the rims of holes, which the template does not have; they were left out");
  }

  Result<void> show(const Points& points, double done) const {
    if (options_.show) options_.show(points);
    if (options_.progress == nullptr) return {};
    options_.progress->report(done);
    return options_.progress->cancelled() ? Result<void>(fail("", "the fit was cancelled")) : Result<void>{};
  }

  const Template& template_;
  const FitOptions& options_;
  std::size_t holes_ = 0;
  ContourTarget target_;
  Similarity placement_;
  VertexScalars trust_;  ///< trust in the landmarks
};

}  // namespace

ContourDistance contour_distance(const std::vector<DrawnContour>& contours, const Mesh& mesh) {
  std::size_t holes = 0;
  const VertexScalars off =
      ContourTarget(samples_for(*mesh.topology, contours, contour_pieces, holes)).off_pieces_mm(mesh);
  if (off.size() == 0) return {};
  return {off.mean(), quantile(std::vector<double>(off.begin(), off.end()), 0.95)};
}

Result<FitResult> fit_to_contours(const Template& the_template, const std::vector<DrawnContour>& contours,
                                  const FitOptions& options) {
  return ContourFitting(the_template, contours, options).alone();
}

Result<FitResult> fit_to_contours_and_boundary(const Template& the_template, const std::vector<DrawnContour>& contours,
                                               const Boundary& boundary, const FitOptions& options) {
  auto fit = fit_to_boundary(the_template, boundary, options);
  if (!fit) return fit;
  fit->warnings.insert(fit->warnings.begin(), boundary.warnings.begin(), boundary.warnings.end());
  return ContourFitting(the_template, contours, options).with(boundary, std::move(*fit));
}

std::vector<Pin> contour_pins(const std::vector<DrawnContour>& contours, const Mesh& mesh) {
  ContourSamples drawn = sampled_contours(contours, most_pins);
  std::erase_if(drawn.samples, [](const ContourSample& one) { return one.outside || one.hole; });
  const ContourTarget target(std::move(drawn));
  std::vector<Pin> pins;
  for (const ContourMeeting& met : target.meetings(mesh))
    pins.push_back({met.on, target.contours().samples[met.sample].at});
  return pins;
}

}  // namespace homolog
