#pragma once

#include <vector>

#include "core/adapt/ways/fit_context.h"

namespace homolog {

/// One template on its way to one boundary. Lives as long as both and the options do. The boundary comes in here alone:
/// what follows draws to the target that is made of it.
class Fitting {
 public:
  Fitting(const Template& the_template, const Boundary& boundary, const FitOptions& options);
  Fitting(const Fitting&) = delete;
  Fitting& operator=(const Fitting&) = delete;

  /// Brings the template to the boundary; `finish` then tells what came of it. `about_right`: meshes (n×3, LPS mm) from
  /// which a partial fit begins too.
  Result<void> to_boundary(std::vector<Points> about_right = {});

  /// The boundary is cut off only as the template is: a match then looks at all of it.
  void match_beyond_cuts() { matches_beyond_cuts_ = true; }

  const Mesh& mesh() const { return shape_.mesh; }
  const std::vector<std::int32_t>& lacking() const { return lacking_; }
  /// The template's own form under the similarity nearest to the mesh, n×3, LPS mm.
  Points form_placed() const;

  /// Returns the result. Call it once, at the end: the mesh moves out.
  FitResult finish();

  /// First the nearest of the allowed shapes; what follows keeps to that. `lacking`: what the boundary is known to
  /// lack, vertices in rising order.
  Result<FitResult> among_allowed(std::vector<std::int32_t> lacking);

 private:
  /// The vertices of an allowed shape that the boundary lacks: it is far off there for the noise with which it lies on
  /// the rest.
  std::vector<std::int32_t> beyond_noise(const Mesh& mesh);

  /// Puts this mesh where the target lacks the organ: it guesses better than a patch over the hole, or its rim.
  /// Around it the shape goes over to what the boundary asks.
  void keep_where_lacking(const Points& likely);

  /// Places the template; with landmarks it is warped then.
  Result<void> place();
  /// What the ways onto the boundary share.
  FitContext context();
  /// Neither cut off by the scan nor lacking parts.
  bool whole() const { return target_.boundary().scan_borders.empty() && !options_.partial; }

  /// A partial fit: of several ways the likeliest says what is missing.
  Result<void> adapt_to_parts();
  /// Several ways onto the boundary, and what is made of them [WholeWays].
  Result<void> adapt_to_whole();

  /// Says how far the ways onto the boundary spread about the mesh, squared, by vertex.
  VertexScalars spread_mm2() const;

  /// `done`: of the part of the work that is under way.
  Result<void> show(const Points& points, double done);

  const Template& template_;
  const FitOptions& options_;
  double round_;       ///< the organ, as its template tells: 0 … 1
  double smooth_ = 0;  ///< how much a smooth warp decided, of a round organ: 0 … round_
  SurfaceTarget target_;
  FitSteps steps_;
  PlacedTemplate placed_;
  Adapting shape_;             ///< as placed, at first; in the end what the fit makes
  std::vector<Adapted> ways_;  ///< the plain one first
  PartsOfWork parts_;
  std::vector<Points> about_right_;
  bool matches_beyond_cuts_ = false;
  std::vector<std::int32_t> lacking_;  ///< the vertices at which the boundary lacks the organ, of a partial fit
};

}  // namespace homolog
