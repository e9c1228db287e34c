#include "core/groupwise/optimise.h"

#include <algorithm>

#include "core/base/processes/parallel.h"
#include "core/deform/fold_guard.h"
#include "core/measure/compare.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/model/measures/measures.h"

namespace homolog {

namespace {

constexpr int measured_modes = 3;
constexpr Eigen::Index samples = 1000;
constexpr std::uint64_t seed = 1;

SetFigures figures_of(ShapeMatrix shapes, Alignment alignment, const GroupwiseRound& round) {
  SetFigures figures{round.bits, round.position_bits};
  align(shapes, alignment);
  const PrincipalComponents components = principal_components(std::move(shapes));
  figures.modes = std::min<int>(measured_modes, static_cast<int>(components.shapes()) - 2);
  if (figures.modes < 1) {
    figures.modes = 0;
    return figures;
  }
  const auto at = static_cast<std::size_t>(figures.modes - 1);
  figures.compactness = compactness(components)[at].mean;
  figures.generalisation_rms = generalisation_rms(components)[at].mean;
  figures.specificity_rms = specificity_rms(components, samples, seed)[at].mean;
  return figures;
}

}  // namespace

VertexScalars held_vertices(const MeshFile& shape, const Topology& topology, bool landmarks) {
  VertexScalars held = VertexScalars::Zero(shape.points.rows());
  if (const auto confirmed = shape.arrays.find("confirmed"); confirmed != shape.arrays.end())
    held = (confirmed->second.array() > 0).cast<double>();
  if (landmarks)
    for (const Landmark& landmark : shape.landmarks) {
      const auto nearest = nearest_on_surface(topology, shape.points, landmark.position);
      for (const std::int32_t v : topology.triangles().row(nearest.at.face)) held[v] = 1;
    }
  return held.maxCoeff() > 0 ? held : VertexScalars();
}

Result<OptimisedSet> optimise_set(const TrainingSet& set, const GroupwiseOptions& options) {
  if (!set.topology)
    return fail(set.names.front(),
                "has points only, and vertices slide along faces; give meshes of the same numbering");
  auto slid = slide_together(set.topology, set.shapes, options);
  if (!slid) return fail(slid.error());
  OptimisedSet optimised;
  optimised.shapes = std::move(slid->shapes);
  optimised.largest_slide_mm = std::move(slid->largest_slide_mm);
  optimised.before = figures_of(set.shapes, options.alignment, slid->rounds.front());
  optimised.after = figures_of(optimised.shapes, options.alignment, slid->rounds.back());
  const auto count = static_cast<std::size_t>(set.shapes.cols());
  std::vector<double> moved_mm(count);
  std::vector<std::size_t> turned(count);
  for_each_in_parallel(count, [&](std::size_t k) {
    const auto column = static_cast<Eigen::Index>(k);
    const Mesh before{set.topology, points_of(set.shapes, column)},
        after{set.topology, points_of(optimised.shapes, column)};
    moved_mm[k] = std::max(surface_distance(before, after).max_mm, surface_distance(after, before).max_mm);
    turned[k] = turned_triangles(*set.topology, before.points, after.points).size();
  });
  for (std::size_t k = 0; k < count; ++k) {
    optimised.surface_moved_mm = std::max(optimised.surface_moved_mm, moved_mm[k]);
    optimised.turned_triangles += turned[k];
  }
  return optimised;
}

}  // namespace homolog
