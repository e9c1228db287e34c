#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/adapt/force.h"
#include "core/base/result.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/solve/shape_solver.h"

namespace homolog {

/// A point of a mesh's surface that goes to a place, LPS mm.
struct Pin {
  SurfacePoint on;
  Vec3 place = Vec3::Zero();
};

/// A mesh that adapts, and the reference that it keeps to. All n×3.
struct Adapting {
  Mesh mesh;                       ///< P, LPS mm
  Points rest;                     ///< the reference in a frame of its own
  Similarity placement;            ///< from there to the mesh
  Points placed;                   ///< R: `rest` under `placement`, LPS mm
  VertexScalars factors;           ///< factors of the stiffness; their mean is 1
  std::vector<std::int32_t> held;  ///< vertices that stay exactly where they are
  /// On triangles of which not all corners are held: met by every solve, exactly unless they contradict each other.
  std::vector<Pin> pins;

  /// Lays the reference anew on the mesh as it is now.
  void place_anew();
};

/// How the stiffness falls: its length [stiffness_length_mm] goes from a share of the mesh's diagonal to
/// `softest_edges` mean edges, which lets the mesh follow the boundary. A share of 0.3 moves the mesh as a whole first;
/// what is matched already needs less.
struct Annealing {
  int steps;
  double softest_edges;
  double stiffest_share = 0.3;
};

/// The force on a mesh as it is now; `share`: 0 at the first step, 1 at the last.
using ForceSource = std::function<Force(const Mesh& mesh, double share)>;
/// Called after each step with its share; its error ends the annealing. May be empty.
using AfterStep = std::function<Result<void>(double share)>;

/// Draws a mesh to what `force` looks for: solves Eq. 3 again and again [Erdt 2009, §2.2] while the stiffness falls.
/// After each step the reference is placed anew by a similarity. For each solve it is turned with the shape, one-ring
/// by one-ring. A fit and a snap differ only in their force and in what follows. `solver`: of the mesh's topology; it
/// is factorised anew, so its present factor is lost. Errors: arrays that are not of the mesh, or a force that is not;
/// numbers that are not finite; a held vertex or a pin beyond the mesh; a solver of another mesh; those of
/// ShapeSolver::factorise and of `after_step`.
Result<void> anneal(Adapting& shape, ShapeSolver& solver, const Annealing& annealing, const ForceSource& force,
                    const AfterStep& after_step = {});

}  // namespace homolog
