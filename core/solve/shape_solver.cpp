#include "core/solve/shape_solver.h"

#include <cassert>
#include <cmath>

#include "core/solve/sparse_cholesky.h"

namespace homolog {

namespace {

/// The lower triangle of M + H, values unset. Edges come sorted with the lower index first, so it is, column by column,
/// each diagonal entry followed by its edges: edge k of column i sits at slot k + i + 1.
Eigen::SparseMatrix<double> lower_triangle(const Topology& topology) {
  const auto& edges = topology.edges();
  const int n = static_cast<int>(topology.vertices());
  Eigen::SparseMatrix<double> lower(n, n);
  lower.resizeNonZeros(n + static_cast<Eigen::Index>(edges.size()));
  std::size_t edge = 0;
  for (int i = 0; i < n; ++i) {
    int slot = i + static_cast<int>(edge);
    lower.outerIndexPtr()[i] = slot;
    lower.innerIndexPtr()[slot] = i;
    for (; edge < edges.size() && edges[edge][0] == i; ++edge) lower.innerIndexPtr()[++slot] = edges[edge][1];
  }
  lower.outerIndexPtr()[n] = n + static_cast<int>(edges.size());
  return lower;
}

}  // namespace

struct ShapeSolver::Factor {
  explicit Factor(const Topology& topology) : lower(lower_triangle(topology)), cholesky(lower) {}

  Eigen::SparseMatrix<double> lower;
  SparseCholesky cholesky;
};

ShapeSolver::ShapeSolver(std::shared_ptr<const Topology> topology)
    : topology_(std::move(topology)), factor_(std::make_unique<Factor>(*topology_)) {}

ShapeSolver::~ShapeSolver() = default;
ShapeSolver::ShapeSolver(ShapeSolver&&) noexcept = default;
ShapeSolver& ShapeSolver::operator=(ShapeSolver&&) noexcept = default;

Result<void> ShapeSolver::factorise(const VertexScalars& w, const VertexScalars& hold) {
  assert(w.size() == topology_->vertices() && (hold.size() == 0 || hold.size() == w.size()));
  for (Eigen::Index i = 0; i < w.size(); ++i) {
    if (!std::isfinite(w[i]) || w[i] <= 0) {
      return fail("stiffness", "of landmark " + std::to_string(i) + " is not a positive number; paint it anew");
    }
  }
  auto& lower = factor_->lower;
  const int* start = lower.outerIndexPtr();
  double* value = lower.valuePtr();
  for (Eigen::Index i = 0; i < w.size(); ++i) value[start[i]] = hold.size() > 0 ? 1 + hold[i] : 1;
  const auto& edges = topology_->edges();
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const auto [i, j] = edges[k];
    const double weight = w[i] + w[j];
    value[static_cast<std::size_t>(i) + k + 1] = -weight;
    value[start[i]] += weight;
    value[start[j]] += weight;
  }
  if (!factor_->cholesky.factorise(lower)) {
    return fail("stiffness", "spans too many orders of magnitude to be solved; narrow its range");
  }
  w_ = w;
  hold_ = hold;
  return {};
}

VertexScalars ShapeSolver::solve(const VertexScalars& b) const {
  return factor_->cholesky.solve(b);
}

Points ShapeSolver::solve(const Points& b) const {
  return factor_->cholesky.solve(b);
}

VertexScalars firm_hold(const Topology& topology, const VertexScalars& w, const VertexScalars& held) {
  VertexScalars pull = VertexScalars::Ones(w.size());
  for (const auto& [i, j] : topology.edges()) {
    pull[i] += w[i] + w[j];
    pull[j] += w[i] + w[j];
  }
  return 1e4 * pull.cwiseProduct(held);
}

double stiffness_length_mm(double w, double edge_mm) {
  return edge_mm * std::sqrt(3 * w);
}
double stiffness_from_length(double length_mm, double edge_mm) {
  return length_mm * length_mm / (3 * edge_mm * edge_mm);
}

}  // namespace homolog
