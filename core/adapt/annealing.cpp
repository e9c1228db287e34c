#include "core/adapt/annealing.h"

#include <Eigen/QR>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/deform/local_rotations.h"
#include "core/mesh/check_mesh.h"
#include "core/mesh/mesh_quality.h"
#include "core/placement/similarity_fit.h"

namespace homolog {

namespace {

/// Weighs held vertices so that their surroundings fade towards them and are not torn from them.
void hold(const Adapting& shape, const VertexScalars& w, Force& force) {
  for (const std::int32_t i : shape.held) {
    double pulled = force.weights[i];
    for (const std::int32_t j : shape.mesh.topology->one_ring(i)) pulled += w[i] + w[j];
    force.weights[i] = holding_weight * pulled;
    force.pulls.row(i) = force.weights[i] * shape.mesh.points.row(i);
  }
}

/// The places of the pins, k×3, and each one's weights at its corners: a column of n values.
struct PinnedPlaces {
  Points to;
  Eigen::SparseMatrix<double> weights;

  PinnedPlaces(const Adapting& shape)
      : to(std::ssize(shape.pins), 3), weights(shape.mesh.points.rows(), std::ssize(shape.pins)) {
    const auto& triangles = shape.mesh.topology->triangles();
    for (Eigen::Index k = 0; k < to.rows(); ++k) {
      const Pin& pin = shape.pins[k];
      to.row(k) = pin.place.transpose();
      for (int c = 0; c < 3; ++c) weights.coeffRef(triangles(pin.on.face, c), k) += pin.on.weights[c];
    }
  }
};

/// The solution of Eq. 3 under the condition that the pins are met, from the one without it: what M spreads from each
/// pin's corners is added.
void meet_pins(const Adapting& shape, const ShapeSolver& solver, Points& solved) {
  if (shape.pins.empty()) return;
  const PinnedPlaces pinned(shape);
  Eigen::MatrixXd spread(solved.rows(), pinned.to.rows());
  for (Eigen::Index k = 0; k < spread.cols(); ++k)
    spread.col(k) = solver.solve(VertexScalars(Eigen::VectorXd(pinned.weights.col(k))));
  const Eigen::MatrixXd between = pinned.weights.transpose() * spread;
  const Eigen::MatrixXd off = pinned.to - pinned.weights.transpose() * solved;
  // Two pins in one place cannot both be met: the least squares between them.
  Eigen::MatrixXd way = spread * between.completeOrthogonalDecomposition().solve(off);
  // Pins that contradict each other nearly in one place would tear the shape apart: they are met as far as it can bend.
  constexpr double torn = 10, yielding = 1e-3;
  if (!(way.cwiseAbs().maxCoeff() < torn * off.cwiseAbs().maxCoeff())) {
    const double give = yielding * between.diagonal().maxCoeff();
    way = spread * (between + give * Eigen::MatrixXd::Identity(off.rows(), off.rows())).ldlt().solve(off);
  }
  solved += way;
}

/// Eq. 3 with these forces and a reference that turns with the shape.
Result<void> solve(Adapting& shape, ShapeSolver& solver, double stiffness, Force force) {
  const Topology& topology = *shape.mesh.topology;
  const VertexScalars w = stiffness / least_weight * shape.factors;
  hold(shape, w, force);
  if (auto ready = solver.factorise(w, (force.weights.array() - 1).matrix()); !ready) return ready;
  const auto rotations = local_rotations(topology, shape.placed, shape.mesh.points);
  Points solved = solver.solve(Points(force.pulls + rotated_reference_force(topology, w, shape.placed, rotations)));
  meet_pins(shape, solver, solved);
  for (const std::int32_t i : shape.held) solved.row(i) = shape.mesh.points.row(i);
  shape.mesh.points = std::move(solved);
  return {};
}

/// What a program may have put together wrongly.
Result<void> check_adapting(const Adapting& shape, const ShapeSolver& solver) {
  if (auto sound = check_mesh(shape.mesh, "the mesh that adapts"); !sound) return sound;
  const Topology& topology = *shape.mesh.topology;
  const Eigen::Index vertices = topology.vertices(), faces = topology.triangles().rows();
  if (auto sound = check_points(shape.rest, vertices, "the reference"); !sound) return sound;
  if (auto sound = check_points(shape.placed, vertices, "the reference as placed"); !sound) return sound;
  if (auto counted = check_count(shape.factors.size(), vertices, "the stiffness"); !counted) return counted;
  const auto is_vertex = [&](std::int32_t i) { return i >= 0 && i < vertices; };
  const auto is_pin = [&](const Pin& pin) {
    return pin.on.face >= 0 && pin.on.face < faces && pin.on.weights.allFinite() && pin.place.allFinite();
  };
  if (!std::ranges::all_of(shape.held, is_vertex) || !std::ranges::all_of(shape.pins, is_pin))
    return fail("", "a held vertex or a pin is not on the mesh that adapts; leave it out");
  if (solver.topology() != shape.mesh.topology && solver.topology()->hash() != topology.hash())
    return fail("", "the solver is of another mesh; make one of this mesh's topology");
  return {};
}

Result<void> check_force(const Force& force, Eigen::Index vertices) {
  if (auto counted = check_count(force.weights.size(), vertices, "the force's weights"); !counted) return counted;
  return check_points(force.pulls, vertices, "the force's pulls");
}

}  // namespace

void Adapting::place_anew() {
  placement = nearest_similarity(rest, mesh.points, placement);
  placed = placement.apply(rest);
}

Result<void> anneal(Adapting& shape, ShapeSolver& solver, const Annealing& annealing, const ForceSource& force,
                    const AfterStep& after_step) {
  if (auto sound = check_adapting(shape, solver); !sound) return sound;
  const double edge_mm = mean_edge_mm(*shape.mesh.topology, shape.mesh.points);
  const double first_mm = annealing.stiffest_share * bounds_of(shape.mesh.points).diagonal().norm();
  const double last_mm = annealing.softest_edges * edge_mm;
  for (int step = 0; step < annealing.steps; ++step) {
    const double share = annealing.steps > 1 ? static_cast<double>(step) / (annealing.steps - 1) : 1;
    const double length_mm = first_mm * std::pow(last_mm / first_mm, share);
    const double stiffness = stiffness_from_length(length_mm, edge_mm);
    Force drawing = force(shape.mesh, share);
    if (auto sound = check_force(drawing, shape.mesh.topology->vertices()); !sound) return sound;
    if (auto done = solve(shape, solver, stiffness, std::move(drawing)); !done) return done;
    shape.place_anew();
    if (!after_step) continue;
    if (auto done = after_step(share); !done) return done;
  }
  return {};
}

}  // namespace homolog
