#pragma once

#include <Eigen/SparseCore>

#include "core/mesh/topology.h"

namespace homolog {

/// Λ, n×n: the graph Laplacian whose edge (i,j) weighs w_i + w_j, since each edge stands in both one-rings
/// [Erdt 2009, Eq. 1]. `w`: n stiffness weights > 0.
Eigen::SparseMatrix<double> shape_laplacian(const Topology& topology, const VertexScalars& w);

/// A of the paper's overdetermined system A p = b [Erdt 2009, §2.2], stacked: n rows of E_force, then √w_i (p_i − p_j)
/// for every i and every j in its one-ring. AᵀA = I + Λ exactly; the solver assembles that directly.
Eigen::SparseMatrix<double> stacked_system(const Topology& topology, const VertexScalars& w);

/// E = E_force + E_shape [Erdt 2009, Eq. 1–3] of points `p` for reference `r` and force targets `s`, all n×3 mm; in
/// mm².
double deformation_energy(const Topology& topology, const VertexScalars& w, const Points& p, const Points& r,
                          const Points& s);

/// S(P) = (I + Λ) P − Λ R: the only force targets whose minimiser is `p`.
Points implied_targets(const Topology& topology, const VertexScalars& w, const Points& p, const Points& r);

}  // namespace homolog
