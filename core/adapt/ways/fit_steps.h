#pragma once

#include <functional>

#include "core/adapt/annealing.h"
#include "core/adapt/fit.h"
#include "core/adapt/target.h"

namespace homolog {

/// From a template that is placed.
inline constexpr Annealing from_placement{.steps = 16, .softest_edges = 1};

/// The result of the steps from a start.
struct Adapted {
  Adapting shape;
  double strain;   ///< see FitSteps::strain
  double off_mm2;  ///< see Target::off_mm2
};

/// The steps that bring a template's mesh to a target; a fit is made of them [fit_to_boundary]. Each tells `show` how
/// it goes, and ends with its error.
class FitSteps {
 public:
  /// Sees the vertices (n×3, LPS mm) after each step, and how much of this way is done, 0 … 1.
  using Show = std::function<Result<void>(const Points& points, double done)>;

  /// All but `show` outlive the steps.
  FitSteps(const Template& the_template, Target& target, const FitOptions& options, Show show);

  /// How far each of the landmarks that the template has is believed, 0 … 1. To be said before anything is drawn.
  void trust(VertexScalars landmarks) { trust_ = std::move(landmarks); }

  /// A mesh that begins at `points` (n×3, LPS mm), annealed to the target and settled there. Its reference (n×3, in
  /// a frame of its own) is eased while it anneals. `placement`: about, from there.
  Result<Adapted> adapt(const Points& points, const Similarity& placement, const Points& reference,
                        const Annealing& annealing);

  /// Draws the mesh to the target and the landmarks. It keeps to `shape.rest`.
  Result<void> anneal_to_target(Adapting& shape, const Annealing& annealing);

  /// Vertices onto the target, evenly spread as in `shape.rest`.
  Result<void> settle(Adapting& shape);

  /// The same where the mesh as it is now is the reference to keep to.
  Result<void> settle_as_it_is(Adapting& shape);

  /// Slides vertices along the target's surface to where that faces as the template does [FacingSearch]. `share`: how
  /// much of the way, 0 … 1. The shape stays as it is where it would end farther off the target.
  Result<void> slide_to_facing(Adapting& shape, const Mesh& surface, double share);

  /// The pull of the target and that of the landmarks. `share`: of an annealing, 0 … 1. `placement`: of the template,
  /// about.
  Force force(const Mesh& mesh, const Similarity& placement, double share);

  /// Says how far the shape strains the template under its nearest similarity [strain_share].
  double strain(const Adapting& shape) const;

  /// If a way ends off the target by such an `off_mm2`, another that ends farther off than this, as root mean
  /// square, does not lie on it. A share of the organ, so that it does not depend on how fine the mesh is.
  double most_off_mm(double left_mm2) const;

  /// A shape (n×3) where the template lies before it is placed.
  Points unplaced(const Points& shape) const;

 private:
  Points template_placed(const Adapting& shape) const;
  Result<Points> eased(const Points& reference);
  Force with_landmarks(TargetPull pull, const Mesh& mesh) const;

  const Template& template_;
  Target& target_;
  const FitOptions& options_;
  Show show_;
  ShapeSolver solver_;
  VertexScalars factors_;  ///< factors of the stiffness; their mean is 1
  VertexScalars trust_;    ///< trust in each landmark that was given
};

}  // namespace homolog
