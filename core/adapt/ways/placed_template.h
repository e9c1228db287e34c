#pragma once

#include <string>
#include <vector>

#include "core/adapt/fit.h"
#include "core/placement/known_matches.h"
#include "core/placement/likely_similarity.h"

namespace homolog {

/// A template as a fit places it on a boundary, with what the organ's landmarks say.
struct PlacedTemplate {
  Similarity placement;                       ///< the organ's place
  Points points;                              ///< n×3, LPS mm: the template under it
  VertexScalars trust;                        ///< trust in each landmark that was given and that the template has
  KnownMatches landmarks;                     ///< those given and mirrored, from `points`
  std::vector<SurfacePoint> landmark_places;  ///< the template's place for each of these
  std::vector<std::string> warnings;          ///< each a sentence

  /// Whether landmarks had a say in the placement.
  bool by_landmarks() const { return trust.size() >= fewest_placing_landmarks; }
  /// The landmarks from where they lie on the template as it is now (n×3, LPS mm).
  KnownMatches known_on(const Topology& topology, const Points& points) const;
};

/// Places a template: as the options say, else where it is likeliest [find_placement]. If the boundary shows all of
/// the organ, landmarks of a symmetric one say where their mirror images belong. Errors: the placement given does not
/// reach the boundary.
Result<PlacedTemplate> place_template(const Template& the_template, const Boundary& boundary,
                                      const FitOptions& options);

}  // namespace homolog
