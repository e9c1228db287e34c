#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/adapt/adaptation.h"
#include "core/adapt/boundary/boundary_search.h"
#include "core/adapt/boundary/boundary_warp.h"
#include "core/adapt/fit.h"

namespace homolog {

/// One template on its way to one boundary. Lives as long as both and the options do.
class Fitting {
 public:
  Fitting(const Template& the_template, const Boundary& boundary, const FitOptions& options);

  /// Brings the template to the boundary; `finish` then tells what came of it. `about_right`: meshes (n×3, LPS mm) from
  /// which a partial fit begins too.
  Result<void> to_boundary(std::vector<Points> about_right = {});

  /// The boundary is cut off only as the template is: a match then looks at all of it.
  void match_beyond_cuts() { matches_beyond_cuts_ = true; }

  const Mesh& mesh() const { return shape_.mesh; }
  const std::vector<std::int32_t>& lacking() const { return lacking_; }
  /// The template's own form under the similarity nearest to the mesh, n×3, LPS mm.
  Points form_placed() const;

  /// What came of it. Once, at the end: the mesh moves out.
  FitResult finish();

  /// First the nearest of the allowed shapes; what follows keeps to that. `lacking`: what the boundary is known to
  /// lack, vertices in rising order.
  Result<FitResult> among_allowed(std::vector<std::int32_t> lacking);

 private:
  /// Where an adaptation begins.
  struct Start {
    Points points;         ///< n×3, LPS mm
    bool matched = false;  ///< with the boundary as a whole, so that it is near and its own reference
  };

  /// What the boundary lacks of an allowed shape: it is far off there for the noise with which it lies on the rest.
  std::vector<std::int32_t> beyond_noise(const Mesh& mesh);

  /// Where the target lacks the organ this mesh is the better guess: a patch over the hole, or its rim, is no target.
  /// Around it the shape goes over to what the boundary asks.
  void keep_where_lacking(const Points& likely);

  Result<void> place();

  /// `from`: where the template's landmarks are under its similarity; `to`: where they belong, k×3.
  void know_landmarks(const Points& placed, const Points& from, const Points& to);

  /// Neither cut off by the scan nor lacking parts.
  bool whole() const { return boundary_.scan_borders.empty() && !options_.partial; }
  bool warped() const { return trust_.size() >= fewest_placing_landmarks; }

  /// The landmarks from where they lie on the template as it is now (n×3, LPS mm).
  KnownMatches known_on(const Points& points) const;

  /// The template as placed or, with landmarks, warped; then that matched with the boundary where that shows the whole.
  std::vector<Start> starts() const;

  /// A partial fit: of several ways the likeliest says what is missing.
  Result<void> adapt_to_parts();

  /// Several ways onto the boundary: the plain fit is kept, or those from matches are averaged, or a mean of both.
  Result<void> adapt_from_starts();

  /// Whether a smooth displacement alone takes the template to the boundary: 1 where this match lies on it, 0 where the
  /// organ has a shape that no smooth displacement gives.
  double differs_smoothly(const Start& match);

  /// The mean of the ways that lie on the boundary, n×3, those of less energy counting far more. The plain fit is
  /// weighed by `plain_counts`; with landmarks the others by how far they are believed, else the mean is judged. None
  /// where no way counts.
  std::optional<Points> mean_way(double plain_counts) const;

  /// From one start to the boundary.
  Result<Adapted> adapt(const Start& start, const Similarity& placement);

  /// Of the ways onto the boundary about the mesh, squared, by vertex.
  VertexScalars spread_mm2() const;

  /// `done`: of the part of the work that is under way.
  Result<void> show(const Points& points, double done);

  const Template& reference_;
  const Boundary& boundary_;
  const FitOptions& options_;
  double round_;       ///< the organ, as its template tells: 0 … 1
  double smooth_ = 0;  ///< how much a smooth warp decided, of a round organ: 0 … round_
  BoundarySearch search_;
  Adaptation adaptation_;
  Adapting shape_;                                              ///< as placed, at first; in the end what the fit makes
  std::vector<Adapted> ways_;                                   ///< the plain fit first
  Similarity found_;                                            ///< where the organ is
  VertexScalars trust_;                                         ///< of each landmark that was given
  KnownMatches landmarks_;                                      ///< those given and mirrored, from the placed template
  std::vector<SurfacePoint> landmark_places_;                   ///< on the template, of each of these
  std::pair<std::size_t, std::size_t> part_of_progress_{0, 1};  ///< which of how many
  std::vector<std::string> landmark_warnings_;
  std::vector<Points> about_right_;
  bool matches_beyond_cuts_ = false;
  std::vector<std::int32_t> lacking_;  ///< of a partial fit: where the boundary lacks the organ
};

}  // namespace homolog
