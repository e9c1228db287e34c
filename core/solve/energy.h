#pragma once

#include <Eigen/SparseCore>

#include "core/mesh/topology.h"

namespace homolog {

/// Λ, n×n: the graph Laplacian whose edge (i,j) weighs w_i + w_j, since each edge stands in both one-rings
/// [Erdt 2009, Eq. 1]. `w`: n stiffness weights > 0.
Eigen::SparseMatrix<double> shape_laplacian(const Topology& topology, const VertexScalars& w);

/// E = E_force + E_shape [Erdt 2009, Eq. 1–3] of points `p` for reference `r` and force targets `s`, all n×3 mm; in
/// mm².
double deformation_energy(const Topology& topology, const VertexScalars& w, const Points& p, const Points& r,
                          const Points& s);

}  // namespace homolog
