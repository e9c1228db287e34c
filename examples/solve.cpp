// The energy and its solver: one point of a sphere is pulled outward, the others follow as stiffness tells them.
//
//     example_solve

#include <cmath>
#include <cstdio>

#include "core/mesh/construction/icosphere.h"
#include "core/solve/energy.h"
#include "core/solve/shape_solver.h"

using namespace homolog;

int main() {
  const Mesh sphere = icosphere(3, 50);  // 642 landmarks, radius 50 mm
  const Points& reference = sphere.points;

  // Equal stiffness, given as the length over which an edit spreads.
  constexpr double edge_mm = 8, length_mm = 20;
  const VertexScalars stiffness = VertexScalars::Constant(reference.rows(), stiffness_from_length(length_mm, edge_mm));

  // A topology is analysed once, stiffness is factorised once, and every drag costs one solve.
  ShapeSolver solver(sphere.topology);
  if (const auto ready = solver.factorise(stiffness); !ready) {
    std::fprintf(stderr, "%s\n", ready.error().sentence().c_str());
    return 1;
  }

  // Force targets S: the reference, but for one landmark that is wanted 30 mm further out.
  // M P = S + Λ R [Erdt 2009, Eq. 3 as normal equations].
  Points targets = reference;
  targets.row(0) *= (50.0 + 30.0) / 50.0;
  const Points shape = solver.solve(Points(targets + shape_laplacian(*sphere.topology, stiffness) * reference));

  const double before = deformation_energy(*sphere.topology, stiffness, reference, reference, targets);
  const double after = deformation_energy(*sphere.topology, stiffness, shape, reference, targets);
  std::printf("energy %.1f -> %.1f mm^2, the pulled landmark moved %.2f mm\n", before, after,
              (shape.row(0) - reference.row(0)).norm());
  return after < before && (shape.row(0) - reference.row(0)).norm() > 0.1 ? 0 : 1;
}
