#pragma once

#include <functional>

#include "core/adapt/annealing.h"
#include "core/adapt/boundary/boundary_search.h"
#include "core/adapt/fit.h"

namespace homolog {

/// Of the mesh's diagonal: how near counterparts lie in the end where parts may be missing.
inline constexpr double closest_reach = 0.015;

/// What an adaptation made of a start.
struct Adapted {
  Adapting shape;
  double strain;   ///< see Adaptation::strain
  double off_mm2;  ///< see Adaptation::off_mm2
};

/// The steps that bring a template's mesh to a boundary; a fit is made of them [fit_to_boundary]. Each tells `show`
/// how it goes, and ends with its error.
class Adaptation {
 public:
  /// Sees the vertices (n×3, LPS mm) after each step, and how much of this way is done, 0 … 1.
  using Show = std::function<Result<void>(const Points& points, double done)>;

  /// All but `show` outlive the adaptation.
  Adaptation(const Template& the_template, const Boundary& boundary, BoundarySearch& search, const FitOptions& options,
             Show show);

  /// How far each of the landmarks that the template has is believed, 0 … 1. To be said before anything is drawn.
  void trust(VertexScalars landmarks) { trust_ = std::move(landmarks); }

  /// A mesh that begins at `points` (n×3, LPS mm), annealed to the boundary and settled there. Its reference (n×3, in
  /// a frame of its own) is eased while it anneals. `placement`: about, from there.
  Result<Adapted> adapt(const Points& points, const Similarity& placement, const Points& reference,
                        const Annealing& annealing);

  /// Draws the mesh to the boundary and the landmarks. It keeps to `shape.rest`.
  Result<void> anneal_to_boundary(Adapting& shape, const Annealing& annealing);

  /// Vertices onto the boundary, evenly spread as in `shape.rest`.
  Result<void> settle(Adapting& shape);

  /// The same where the mesh as it is now is the reference to keep to.
  Result<void> settle_as_it_is(Adapting& shape);

  /// Slides vertices along the boundary to where it faces as the template does [FacingSearch]. `share`: how much of the
  /// way, 0 … 1. The shape stays as it is where it would end farther off the boundary.
  Result<void> slide_to_facing(Adapting& shape, double share);

  /// The pull of the boundary, in both directions, and that of the landmarks. `share`: of an annealing, 0 … 1; while
  /// parts may be missing, counterparts must lie the nearer the larger it is. `placement`: of the template, about.
  Force force(const Mesh& mesh, const Similarity& placement, double share);

  /// How far the boundary still pulls, squared, on average over vertices. Each counts as a small share of the organ at
  /// most: a fold may hold some back, or show them a counterpart beyond, and they say nothing of the others.
  double off_mm2(const Mesh& mesh);

  /// Of the template under its nearest similarity [strain_share].
  double strain(const Adapting& shape) const;

  /// Where a way ends off the boundary by such an `off_mm2`, another that ends farther off than this, as root mean
  /// square, does not lie on it. A share of the organ, so that it does not depend on how fine the mesh is.
  double most_off_mm(double left_mm2) const;

  /// A shape (n×3) where the template lies before it is placed.
  Points unplaced(const Points& shape) const;

 private:
  Points template_placed(const Adapting& shape) const;
  Result<Points> eased(const Points& reference);
  Force with_landmarks(BoundaryPull pull, const Mesh& mesh) const;

  const Template& reference_;
  const Boundary& boundary_;
  BoundarySearch& search_;
  const FitOptions& options_;
  double size_mm_;  ///< root of the boundary's area
  Show show_;
  ShapeSolver solver_;
  VertexScalars factors_;  ///< of the stiffness; their mean is 1
  VertexScalars trust_;    ///< of each landmark that was given
};

}  // namespace homolog
