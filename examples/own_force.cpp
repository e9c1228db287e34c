// A force of your own: every vertex is drawn to a cylinder, while the reference, turned ring by ring, keeps the
// vertices in their places. `fit` and `snap` work like this, with other forces.
//
//     example_own_force

#include <cstdio>

#include "core/adapt/annealing.h"
#include "core/mesh/construction/icosphere.h"

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

/// Every vertex pulls as hard as one whose place on a boundary is sure.
Force to_cylinder(const Mesh& mesh, double) {
  return {VertexScalars::Constant(mesh.points.rows(), 1 / least_weight), targets_of(mesh.points) / least_weight};
}

double mean_distance_mm(const Points& points) {
  return (targets_of(points) - points).rowwise().norm().mean();
}

}  // namespace

int main() {
  const Mesh ball = icosphere(3, 50);
  const double first_mm = mean_distance_mm(ball.points);

  const Similarity as_it_is;
  Adapting shape{ball, ball.points, as_it_is, ball.points, VertexScalars::Ones(ball.points.rows()), {}};
  ShapeSolver solver(ball.topology);
  if (const auto drawn = anneal(shape, solver, {.steps = 8, .softest_edges = 1}, to_cylinder); !drawn) {
    std::fprintf(stderr, "%s\n", drawn.error().sentence().c_str());
    return 1;
  }

  const double last_mm = mean_distance_mm(shape.mesh.points);
  std::printf("mean distance to the cylinder %.2f -> %.2f mm\n", first_mm, last_mm);
  return last_mm < 0.5 * first_mm ? 0 : 1;
}
