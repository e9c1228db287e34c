#include "core/adapt/fit.h"

#include <cmath>

#include "core/adapt/boundary/cut_faces.h"
#include "core/adapt/boundary/cut_template.h"
#include "core/adapt/ways/fitting.h"
#include "core/mesh/check_mesh.h"
#include "core/mesh/parts/rims.h"
#include "core/placement/similarity_fit.h"

namespace homolog {

namespace {

/// These options with a progress that is a share of theirs, where they have one. `part` outlives them.
FitOptions with_part(const FitOptions& options, double share, std::optional<Progress>& part) {
  FitOptions own = options;
  if (options.progress != nullptr) own.progress = &part.emplace(*options.progress, share);
  return own;
}

/// A partial fit, and the boundary with its cuts and patches marked.
struct PartialFit {
  FitResult fit;
  Boundary marked;
};

/// Begins with what the fit to a whole organ comes to, too. Which flat faces are cuts shows when the template lies on
/// the boundary; then it begins anew without them. Where nothing is missing the organ is whole.
Result<PartialFit> fit_partial(const Template& the_template, const Boundary& boundary, const FitOptions& options) {
  constexpr int rounds = 3;
  constexpr double whole_share = 0.3;  // share of the work
  std::optional<Progress> of_whole;
  FitOptions as_whole = with_part(options, whole_share, of_whole);
  as_whole.partial = false;
  Fitting whole(the_template, boundary, as_whole);
  if (auto done = whole.to_boundary(); !done) return fail(done.error());
  PartialFit parts{{}, boundary};
  const auto flat = flat_faces(boundary.surface, small_face_share);
  std::vector<Points> about_right{whole.mesh().points};
  for (int round = 1;; ++round) {
    std::optional<Progress> of_round;
    const FitOptions own = with_part(options, (1 - whole_share) / rounds, of_round);
    Fitting fitting(the_template, parts.marked, own);
    if (auto done = fitting.to_boundary(about_right); !done) return fail(done.error());
    auto cut = cut_faces(boundary.surface, flat, fitting.mesh(), fitting.form_placed());
    if (cut == parts.marked.cut || round == rounds) {
      parts.fit = fitting.lacking().empty() ? whole.finish() : fitting.finish();
      return parts;
    }
    about_right.push_back(fitting.mesh().points);
    parts.marked.cut = std::move(cut);
  }
}

/// Fits a template that is cut off: placed by what both have, then fitted to what lies on its side of the cuts. Those
/// follow the mesh in a second round.
Result<FitResult> fit_cut_template(const Template& the_template, const Boundary& boundary, const FitOptions& options) {
  std::optional<Progress> of_first, of_second;
  FitOptions near = with_part(options, 0.5, of_first);
  const Similarity placed = find_placement(the_template, boundary,
                                           {.landmarks = options.landmarks,
                                            .orientation = options.orientation,
                                            .start = options.placement,
                                            .cut_template = true})
                                .placement;
  near.placement = placed;
  const Boundary first_cut = cut_as_template(boundary, cut_borders(the_template, placed.apply(the_template.points)));
  Fitting first(the_template, first_cut, near);
  if (boundary.scan_borders.empty()) first.match_beyond_cuts();
  if (auto done = first.to_boundary(); !done) return fail(done.error());
  FitOptions again = with_part(options, 0.5, of_second);
  again.placement = nearest_similarity(the_template.points, first.mesh().points, placed);
  const auto cuts = cut_borders(the_template, first.mesh().points);
  const Boundary second_cut = cut_as_template(boundary, cuts);
  Fitting second(the_template, second_cut, again);
  if (boundary.scan_borders.empty()) second.match_beyond_cuts();
  if (auto done = second.to_boundary(); !done) return fail(done.error());
  FitResult result = second.finish();
  result.template_cuts = cuts;
  return result;
}

/// Rims belong to rims, so both must have as many. Where one of the two has none, the fit is judged [judge_fit].
Result<void> check_rims(const Template& the_template, const Boundary& boundary) {
  const auto own = long_rims({the_template.topology, the_template.points}).size(),
             there = long_rims(boundary.surface).size();
  if (own == there || own == 0 || there == 0) return {};
  const auto count = [](std::size_t rims) { return rims == 1 ? "one rim" : std::to_string(rims) + " rims"; };
  return fail("", "has " + count(there) + " where the template has " + count(own) +
                      "; close holes by repair-mesh, or give a template that is open where the surface is");
}

/// fit_to_boundary to the organ as a whole or in parts.
Result<FitResult> fit_within(const Template& the_template, const Boundary& boundary, const FitOptions& options) {
  if (!options.partial) {
    if (auto alike = check_rims(the_template, boundary); !alike) return fail(alike.error());
    if (!options.allowed && !cut_borders(the_template, the_template.points).empty())
      return fit_cut_template(the_template, boundary, options);
    Fitting fitting(the_template, boundary, options);
    if (options.allowed) return fitting.among_allowed({});
    if (auto done = fitting.to_boundary(); !done) return fail(done.error());
    return fitting.finish();
  }
  constexpr double free_share = 0.7;  // share of the work
  std::optional<Progress> of_free, of_allowed;
  FitOptions to_any = options.allowed ? with_part(options, free_share, of_free) : options;
  to_any.allowed = nullptr;
  auto parts = fit_partial(the_template, boundary, to_any);
  if (!parts) return fail(parts.error());
  if (!options.allowed) return std::move(parts->fit);
  FitOptions near = with_part(options, 1 - free_share, of_allowed);
  if (!near.placement) near.placement = parts->fit.placement;
  return Fitting(the_template, parts->marked, near).among_allowed(std::move(parts->fit.outliers));
}

/// Whether a placement is one at all; where it lies does not matter.
bool is_similarity(const Similarity& placement) {
  return placement.rotation.coeffs().allFinite() && placement.translation.allFinite() &&
         std::isfinite(placement.scale) && placement.scale > 0;
}

}  // namespace

Result<void> check_arguments(const Template& the_template, const FitOptions& options) {
  if (auto sound = check_template(the_template); !sound) return sound;
  if (options.placement && !is_similarity(*options.placement))
    return fail("",
                "the placement holds a number that is not finite, or a size that is not positive; correct it, or leave "
                "it out to let the fit find one");
  for (const auto& [name, place] : options.landmarks)
    if (!place.allFinite())
      return fail("", "the landmark \"" + name + "\" was given no finite place; correct it or leave it out");
  if (!options.allowed) return {};
  if (!options.allowed->nearest)
    return fail("", "the allowed shapes cannot be asked for the nearest one; set `nearest`");
  return check_points(options.allowed->mean, the_template.points.rows(), "the mean of the allowed shapes");
}

VertexScalars outlier_marks(const FitResult& fit) {
  VertexScalars marks = VertexScalars::Zero(fit.mesh.points.rows());
  for (const std::int32_t i : fit.outliers) marks[i] = 1;
  return marks;
}

Result<FitResult> fit_to_boundary(const Template& the_template, const Boundary& boundary, const FitOptions& options) {
  if (auto sound = check_boundary(boundary); !sound) return fail(sound.error());
  if (auto sound = check_arguments(the_template, options); !sound) return fail(sound.error());
  if (!options.allowed) return fit_within(the_template, boundary, options);
  const auto mean = mean_template(the_template, *options.allowed);
  auto fit = fit_within(*mean, boundary, options);
  if (fit) fit->placement = nearest_similarity(the_template.points, fit->mesh.points, fit->placement);
  return fit;
}

}  // namespace homolog
