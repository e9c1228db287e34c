#include "core/fit/refine.h"

#include "core/deform/fold_guard.h"
#include "core/deform/surface_walk.h"
#include "core/deform/tangential.h"
#include "core/fit/mask_fit.h"
#include "core/fit/untangle.h"
#include "core/mesh/mesh_quality.h"
#include "core/placement/similarity_fit.h"
#include "core/solve/shape_solver.h"

namespace homolog {

namespace {

/// `found`, with confirmed vertices back in their place and their surroundings carried along on the surface.
Result<Points> held(const Document& document, const Points& found) {
  const Shape& shape = document.shape();
  const Topology& topology = *document.reference->topology;
  ShapeSolver solver(document.reference->topology);
  const VertexScalars w = document.stiffness_base * *document.stiffness;
  const VertexScalars hold = firm_hold(topology, w, *shape.confirmed);
  if (auto ready = solver.factorise(w, hold); !ready) return fail(ready.error());
  const Points carried = found + solver.solve(Points(hold.asDiagonal() * (*shape.points - found)));
  const SurfaceSearch surface(document.mesh());
  Points back = *shape.points;
  for (Eigen::Index i = 0; i < back.rows(); ++i) {
    if ((*shape.confirmed)[i] == 1) continue;
    // From where it was found, so that it stays on its side of a thin wall.
    const SurfacePoint from = surface.nearest(Vec3(found.row(i))).at;
    back.row(i) = walk_to_nearest(topology, *shape.points, from, carried.row(i).transpose()).position.transpose();
  }
  return back;
}

std::vector<std::string> warnings_of(const Document& document, const Points& points) {
  const Topology& topology = *document.reference->topology;
  const bool turned = !turned_triangles(topology, *document.shape().placed, points).empty();
  const SelfIntersections crossing = find_self_intersections({document.reference->topology, points});
  const std::string remedy = " Look at them (Correspondence, Shape) before you use the mesh in a model.";
  if (turned || !crossing.pairs.empty()) return {"Some triangles are turned or pass through each other." + remedy};
  if (!crossing.all) return {"So many triangles lie close to each other that not all could be compared." + remedy};
  return {};
}

}  // namespace

Result<Refinement> refine(const Document& document, Progress* progress) {
  if (!document.reference || !document.has_shape())
    return fail("", "There is no mesh to refine; load a template first.");
  const Shape& shape = document.shape();
  FitOptions fitting;
  fitting.placement = fit_similarity(document.reference->points, *shape.points, shape.placement);
  fitting.landmarks = shape.landmarks;
  fitting.progress = progress;
  auto fit = fit_to_boundary(*document.reference, {document.mesh(), {}, {}}, fitting);
  if (!fit) return fail(fit.error());
  Points found = std::move(fit->mesh.points);
  if (shape.confirmed) {
    auto kept = held(document, found);
    if (!kept) return fail(kept.error());
    found = std::move(*kept);
  }
  found = on_boundary_loops(document.mesh(), found);
  found = without_turning(*document.reference->topology, *shape.placed, *shape.points, found);
  return Refinement{points_edit(document, found, by_refinement), warnings_of(document, found)};
}

}  // namespace homolog
