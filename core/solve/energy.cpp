#include "core/solve/energy.h"

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

}  // namespace homolog
