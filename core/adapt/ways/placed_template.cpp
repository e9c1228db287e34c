#include "core/adapt/ways/placed_template.h"

#include <utility>

#include "core/adapt/boundary/landmark_pull.h"
#include "core/adapt/boundary/mirrored_landmarks.h"
#include "core/base/numbers/index.h"

namespace homolog {

namespace {

/// The landmarks' places: `from`, where the template's are under its similarity, and `to`, where they belong, k×3.
void know_landmarks(const Template& the_template, const Boundary& boundary, const FitOptions& options,
                    const Points& from, const Points& to, PlacedTemplate& placed) {
  placed.landmarks = known_matches(placed.points, from, to, placed.trust);
  for (std::size_t k = 0; k < the_template.landmarks.size(); ++k)
    if (options.landmarks.contains(the_template.landmarks[k].name))
      placed.landmark_places.push_back(the_template.landmark_points[k]);
  if (!boundary.scan_borders.empty() || options.partial || !placed.by_landmarks()) return;
  const auto mirrored = mirrored_landmarks(the_template, boundary, options.landmarks, placed.trust, placed.placement);
  add_mirrored(mirrored, {the_template.topology, placed.points}, placed.landmarks);
  for (const MirroredLandmark& one : mirrored) placed.landmark_places.push_back(one.place);
}

}  // namespace

KnownMatches PlacedTemplate::known_on(const Topology& topology, const Points& there) const {
  KnownMatches known = landmarks;
  for (std::size_t k = 0; k < landmark_places.size(); ++k)
    known.from.row(static_cast<Eigen::Index>(k)) = landmark_places[k].interpolate(topology, there);
  return known;
}

Result<PlacedTemplate> place_template(const Template& the_template, const Boundary& boundary,
                                      const FitOptions& options) {
  if (options.placement) {
    const Points points = options.placement->apply(the_template.points);
    if (!bounds_of(points).intersects(bounds_of(boundary.surface.points)))
      return fail(
          "", "the placement puts the template beside the organ; correct it, or leave it out to let the fit find one");
  }
  const auto [own, there] = matched_landmarks(the_template, options.landmarks);
  const Placed found = find_placement(the_template, boundary,
                                      {options.landmarks, options.orientation, options.placement, options.partial});
  PlacedTemplate placed;
  placed.placement = found.placement;
  placed.points = found.placement.apply(the_template.points);
  placed.trust = found.trust.size() == own.rows() ? found.trust : VertexScalars::Ones(own.rows());
  const Points from = found.placement.apply(own);
  placed.warnings =
      warnings_of_landmarks(the_template, options.landmarks, placed.trust, (from - there).rowwise().norm());
  // The shapes that are allowed say more than matches of landmarks.
  if (!options.allowed) know_landmarks(the_template, boundary, options, from, there, placed);
  return placed;
}

}  // namespace homolog
