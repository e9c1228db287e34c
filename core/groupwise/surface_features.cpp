#include "core/groupwise/surface_features.h"

#include <array>
#include <cassert>

#include "core/base/processes/parallel.h"
#include "core/mesh/mesh_quality.h"
#include "core/solve/shape_solver.h"

namespace homolog {

namespace {

constexpr std::array smoothing_shares{0.02, 0.04, 0.08};

double mean_edge_of_set(const Topology& topology, const ShapeMatrix& shapes) {
  double sum_mm = 0;
  for (Eigen::Index k = 0; k < shapes.cols(); ++k) sum_mm += mean_edge_mm(topology, points_of(shapes, k));
  return sum_mm / static_cast<double>(shapes.cols());
}

}  // namespace

std::vector<SurfaceFeatures> surface_features(const std::shared_ptr<const Topology>& topology,
                                              const ShapeMatrix& aligned, double size_mm) {
  const double edge_mm = mean_edge_of_set(*topology, aligned);
  std::vector<ShapeSolver> smoothers;
  for (const double share : smoothing_shares) {
    const double stiffness = stiffness_from_length(share * size_mm, edge_mm);
    const auto ready =
        smoothers.emplace_back(topology).factorise(VertexScalars::Constant(topology->vertices(), stiffness));
    assert(ready && "one stiffness for all vertices can be factorised");
    (void)ready;
  }
  std::vector<SurfaceFeatures> features(static_cast<std::size_t>(aligned.cols()));
  for_each_in_parallel(features.size(), [&](std::size_t k) {
    const Mesh mesh{topology, points_of(aligned, static_cast<Eigen::Index>(k))};
    const Points normals = vertex_normals(mesh);
    SurfaceFeatures& own = features[k];
    own.resize(mesh.points.rows(), Eigen::NoChange);
    own.leftCols<3>() = normals;
    for (std::size_t s = 0; s < smoothers.size(); ++s)
      own.col(3 + static_cast<Eigen::Index>(s)) =
          (mesh.points - smoothers[s].solve(mesh.points)).cwiseProduct(normals).rowwise().sum();
  });
  return features;
}

}  // namespace homolog
