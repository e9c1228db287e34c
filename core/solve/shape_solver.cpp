#include "core/solve/shape_solver.h"

#include <cmath>

#include "core/base/demand.h"
#include "core/mesh/check_mesh.h"
#include "core/solve/sparse_cholesky.h"

namespace homolog {

ShapeSolver::ShapeSolver(std::shared_ptr<const Topology> topology) : topology_(std::move(topology)) {
  demand(topology_ != nullptr, "a solver has no topology; give it that of a mesh");
  factor_ = std::make_unique<SparseCholesky>(elimination_plan(*topology_));
}

ShapeSolver::~ShapeSolver() = default;
ShapeSolver::ShapeSolver(ShapeSolver&&) noexcept = default;
ShapeSolver& ShapeSolver::operator=(ShapeSolver&&) noexcept = default;

Result<void> ShapeSolver::factorise(const VertexScalars& w, const VertexScalars& hold) {
  if (auto counted = check_count(w.size(), topology_->vertices(), "the stiffness"); !counted) return counted;
  if (hold.size() != 0)
    if (auto counted = check_count(hold.size(), w.size(), "the weights that hold"); !counted) return counted;
  for (Eigen::Index i = 0; i < w.size(); ++i) {
    if (!std::isfinite(w[i]) || w[i] <= 0) {
      return fail("", "the stiffness of vertex " + std::to_string(i) + " is not a positive number; paint it anew");
    }
  }
  const auto& edges = topology_->edges();
  VertexScalars of_edges(static_cast<Eigen::Index>(edges.size()));
  for (Eigen::Index k = 0; k < of_edges.size(); ++k) {
    const auto [i, j] = edges[k];
    of_edges[k] = w[i] + w[j];
  }
  VertexScalars force = VertexScalars::Ones(w.size());
  if (hold.size() > 0) force += hold;
  if (!factor_->factorise(force, of_edges)) {
    w_.resize(0);
    hold_.resize(0);
    if (!force.allFinite() || !(force.array() > 0).all())
      return fail("", "a force or a hold has a weight that is no positive number; correct it");
    return fail("", "the stiffness spans too many orders of magnitude to be solved; narrow its range");
  }
  w_ = w;
  hold_ = hold;
  return {};
}

void ShapeSolver::check_rows(Eigen::Index rows) const {
  demand(w_.size() > 0, "nothing is factorised; call factorise before solve");
  demand(check_count(rows, w_.size(), "the right-hand side"));
}

VertexScalars ShapeSolver::solve(const VertexScalars& b) const {
  check_rows(b.size());
  return factor_->solve(b);
}

Points ShapeSolver::solve(const Points& b) const {
  check_rows(b.rows());
  return factor_->solve(b);
}

Eigen::Index ShapeSolver::factor_entries() const {
  return factor_->plan().nonzeros();
}

VertexScalars firm_hold(const Topology& topology, const VertexScalars& w, const VertexScalars& held) {
  VertexScalars pull = VertexScalars::Ones(w.size());
  for (const auto& [i, j] : topology.edges()) {
    pull[i] += w[i] + w[j];
    pull[j] += w[i] + w[j];
  }
  return holding_weight * pull.cwiseProduct(held);
}

double stiffness_length_mm(double w, double edge_mm) {
  return edge_mm * std::sqrt(3 * w);
}
double stiffness_from_length(double length_mm, double edge_mm) {
  return length_mm * length_mm / (3 * edge_mm * edge_mm);
}

}  // namespace homolog
