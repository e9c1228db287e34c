#include "core/solve/energy.h"

#include <cmath>
#include <vector>

namespace homolog {

Eigen::SparseMatrix<double> shape_laplacian(const Topology& topology, const VertexScalars& w) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(topology.edges().size() * 4);
  for (const auto& [i, j] : topology.edges()) {
    const double weight = w[i] + w[j];
    entries.insert(entries.end(), {{i, i, weight}, {j, j, weight}, {i, j, -weight}, {j, i, -weight}});
  }
  Eigen::SparseMatrix<double> laplacian(topology.vertices(), topology.vertices());
  laplacian.setFromTriplets(entries.begin(), entries.end());
  return laplacian;
}

Eigen::SparseMatrix<double> stacked_system(const Topology& topology, const VertexScalars& w) {
  const Eigen::Index n = topology.vertices();
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index i = 0; i < n; ++i) entries.emplace_back(i, i, 1.0);
  Eigen::Index row = n;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (const std::int32_t j : topology.one_ring(i)) {
      entries.emplace_back(row, i, std::sqrt(w[i]));
      entries.emplace_back(row, j, -std::sqrt(w[i]));
      ++row;
    }
  }
  Eigen::SparseMatrix<double> a(row, n);
  a.setFromTriplets(entries.begin(), entries.end());
  return a;
}

double deformation_energy(const Topology& topology, const VertexScalars& w, const Points& p, const Points& r,
                          const Points& s) {
  double shape = 0;
  for (Eigen::Index i = 0; i < topology.vertices(); ++i) {
    for (const std::int32_t j : topology.one_ring(i)) {
      shape += w[i] * ((p.row(i) - p.row(j)) - (r.row(i) - r.row(j))).squaredNorm();
    }
  }
  return shape + (p - s).squaredNorm();
}

Points implied_targets(const Topology& topology, const VertexScalars& w, const Points& p, const Points& r) {
  return p + shape_laplacian(topology, w) * (p - r);
}

}  // namespace homolog
