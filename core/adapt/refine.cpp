#include "core/adapt/refine.h"

#include "core/adapt/fit.h"
#include "core/adapt/untangle.h"
#include "core/deform/fold_guard.h"
#include "core/deform/surface_walk.h"
#include "core/deform/tangential.h"
#include "core/mesh/mesh_quality.h"
#include "core/placement/similarity_fit.h"
#include "core/solve/shape_solver.h"

namespace homolog {

namespace {

/// `found`, with confirmed vertices back in their place and their surroundings carried along on the surface.
Result<Points> held(const Mesh& mesh, const RefineStart& start, const Points& found) {
  const Topology& topology = *mesh.topology;
  ShapeSolver solver(mesh.topology);
  const VertexScalars hold = firm_hold(topology, start.stiffness, start.confirmed);
  if (auto ready = solver.factorise(start.stiffness, hold); !ready) return fail(ready.error());
  const Points carried = found + solver.solve(Points(hold.asDiagonal() * (mesh.points - found)));
  const SurfaceSearch surface(mesh);
  Points back = mesh.points;
  for (Eigen::Index i = 0; i < back.rows(); ++i) {
    if (start.confirmed[i] == 1) continue;
    // From where it was found, so that it stays on its side of a thin wall.
    const SurfacePoint from = surface.nearest(Vec3(found.row(i))).at;
    back.row(i) = walk_to_nearest(topology, mesh.points, from, carried.row(i).transpose()).position.transpose();
  }
  return back;
}

std::vector<std::string> warnings_of(const Mesh& refined, const Points& placed) {
  const bool turned = !turned_triangles(*refined.topology, placed, refined.points).empty();
  const SelfIntersections crossing = find_self_intersections(refined);
  const std::string remedy = " Look at them (Correspondence, Shape) before you use the mesh in a model.";
  if (turned || !crossing.pairs.empty()) return {"Some triangles are turned or pass through each other." + remedy};
  if (!crossing.all) return {"So many triangles lie close to each other that not all could be compared." + remedy};
  return {};
}

}  // namespace

Result<RefineResult> refine(const Template& the_template, const RefineStart& start, Progress* progress) {
  const Mesh mesh{the_template.topology, start.points};
  FitOptions fitting;
  fitting.placement = nearest_similarity(the_template.points, mesh.points, start.placement);
  fitting.landmarks = start.landmarks;
  fitting.progress = progress;
  auto fit = fit_to_boundary(the_template, {mesh, {}, {}}, fitting);
  if (!fit) return fail(fit.error());
  Mesh refined = std::move(fit->mesh);
  if (start.confirmed.size() > 0) {
    auto kept = held(mesh, start, refined.points);
    if (!kept) return fail(kept.error());
    refined.points = std::move(*kept);
  }
  refined.points = on_rims(mesh, refined.points);
  refined.points = without_turning(*mesh.topology, start.placed, mesh.points, refined.points);
  return RefineResult{refined.points, warnings_of(refined, start.placed)};
}

}  // namespace homolog
