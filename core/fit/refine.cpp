#include "core/fit/refine.h"

#include "core/deform/fold_guard.h"
#include "core/deform/shape_solver.h"
#include "core/fit/mask_fit.h"
#include "core/mesh/surface_search.h"

namespace homolog {

namespace {

/// Force of a confirmed landmark towards its place, against 1 of every other towards where it was found.
constexpr double hold_weight = 1e4;

/// `found`, with confirmed landmarks back in their place and their surroundings carried along, on the surface.
Result<Points> held(const Document& document, const Points& found) {
  const Shape& shape = document.shape();
  ShapeSolver solver(document.reference->topology);
  const VertexScalars hold = hold_weight * *shape.confirmed;
  if (auto ready = solver.factorise(document.stiffness_base * *document.stiffness, hold); !ready)
    return fail(ready.error());
  const Points carried = found + solver.solve(Points(hold.asDiagonal() * (*shape.points - found)));
  const SurfaceSearch surface(document.mesh());
  Points back = *shape.points;
  for (Eigen::Index i = 0; i < back.rows(); ++i)
    if ((*shape.confirmed)[i] < 1) back.row(i) = surface.nearest(Vec3(carried.row(i))).position.transpose();
  const FoldGuard guard(*document.reference->topology, *shape.placed, *shape.points);
  const auto at = [&](double share) { return Points(*shape.points + share * (back - *shape.points)); };
  return at(guard.accepted_step(1, at));
}

}  // namespace

Result<SetPoints> refine(const Document& document, Progress* progress) {
  if (!document.reference || !document.has_shape())
    return fail("", "There is no mesh to refine; load a template first.");
  const Shape& shape = document.shape();
  FitOptions fitting;
  fitting.placement = shape.placement;
  fitting.landmarks = shape.landmarks;
  fitting.progress = progress;
  auto fit = fit_to_boundary(*document.reference, {document.mesh(), {}, {}}, fitting);
  if (!fit) return fail(fit.error());
  if (!shape.confirmed) return points_edit(document, fit->mesh.points, by_refinement);
  const auto kept = held(document, fit->mesh.points);
  if (!kept) return fail(kept.error());
  return points_edit(document, *kept, by_refinement);
}

}  // namespace homolog
