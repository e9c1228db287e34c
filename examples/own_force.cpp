// A force of your own: every landmark is drawn to a cylinder, while the reference, turned ring by ring, keeps the
// landmarks in their places. This is how `fit` works, with another force.
//
//     example_own_force

#include <cmath>
#include <cstdio>

#include "core/deform/local_rotations.h"
#include "core/mesh/icosphere.h"
#include "core/mesh/mesh_quality.h"
#include "core/solve/shape_solver.h"

using namespace homolog;

namespace {

constexpr double radius_mm = 40;

/// Where the force wants each point: the nearest place on the cylinder around the z axis.
Points targets_of(const Points& points) {
  Points targets = points;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const double across = points.row(i).head<2>().norm();
    if (across > 5) targets.row(i).head<2>() *= radius_mm / across;
  }
  return targets;
}

double mean_distance_mm(const Points& points) {
  return (targets_of(points) - points).rowwise().norm().mean();
}

}  // namespace

int main() {
  Mesh mesh = icosphere(3, 50);
  const Points reference = mesh.points;
  const double edge_mm = mean_edge_mm(*mesh.topology, reference), first_mm = mean_distance_mm(mesh.points);

  ShapeSolver solver(mesh.topology);
  // From stiff to soft: large things move first, details last.
  for (double length_mm = 40; length_mm > edge_mm; length_mm *= 0.7) {
    const VertexScalars w = VertexScalars::Constant(reference.rows(), stiffness_from_length(length_mm, edge_mm));
    if (const auto ready = solver.factorise(w); !ready) return 1;
    const auto turned = fit_local_rotations(*mesh.topology, reference, mesh.points);
    mesh.points =
        solver.solve(Points(targets_of(mesh.points) + rotated_reference_force(*mesh.topology, w, reference, turned)));
  }
  std::printf("mean distance to the cylinder %.2f -> %.2f mm\n", first_mm, mean_distance_mm(mesh.points));
  return mean_distance_mm(mesh.points) < 0.5 * first_mm ? 0 : 1;
}
