#include "core/assist/assist.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>

#include "core/adapt/refine.h"
#include "core/case/held_landmarks.h"
#include "core/deform/falloff.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

constexpr double least_falloff = 0.05;  ///< of the falloff: beyond it nothing moves

/// Of the edited frame nearest to the shown one; null where there is none.
std::shared_ptr<const Appearance> appearance_of_frames(const Scan& scan, const ShapeView& shown) {
  int best = -1;
  for (const auto& [frame, shape] : shown.structure.shapes) {
    if (frame == shown.frame || shape->strokes == 0) continue;
    if (best < 0 || std::abs(frame - shown.frame) < std::abs(best - shown.frame)) best = frame;
  }
  if (best < 0) return nullptr;
  auto appearance = std::make_shared<Appearance>();
  const Mesh done{shown.the_template().topology, *shown.structure.shape(best)->points};
  if (!appearance->learn(*scan.image, best, done)) return nullptr;
  return appearance;
}

/// How free a vertex is that strokes have carried this far: what they have brought to its place is held, and what they
/// only took along on the way hardly is.
double free_share(double pulled) {
  return 1 - pulled * pulled * pulled;
}

/// Pins the mesh to the placed landmarks that a snap may move it to.
void pin_landmarks(const ShapeView& shown, double reach_mm, SnapStart& start, SnapEdit& edit) {
  const Template& the_template = shown.the_template();
  for (std::size_t l = 0; l < the_template.landmarks.size(); ++l) {
    const LandmarkHold hold = landmark_hold(the_template, l, shown.shape);
    if (!hold.placed) continue;
    if (shown.structure.landmarks.hold && hold.met && !hold.held) continue;  // a person released it
    const SurfacePoint& on = the_template.landmark_points[l];
    const auto corners = the_template.topology->triangles().row(on.face);
    if (std::any_of(corners.begin(), corners.end(), [&](auto corner) { return !(start.free[corner] > 0); })) {
      edit.landmarks += hold.met ? 1 : 0;  // it is held as its vertices are
      continue;
    }
    if (!hold.met && hold.distance_mm > reach_mm) {
      ++edit.far_landmarks;
      continue;
    }
    start.pins.push_back({on, shown.shape.landmarks.at(the_template.landmarks[l].name)});
    ++edit.landmarks;
  }
}

void hold_pulled(const Shape& shape, SnapStart& start, SnapEdit& edit) {
  constexpr double noticed = 0.5;
  if (!shape.pulled) return;
  if (((shape.pulled->array() > noticed) && (start.free.array() > 0)).any()) edit.pulls = shape.pulls;
  start.free.array() *= shape.pulled->unaryExpr(&free_share).array();
}

std::string counted_words(int count, const std::string& one) {
  return std::to_string(count) + " " + one + (count == 1 ? "" : "s");
}

}  // namespace

std::string held_in_words(const SnapEdit& edit) {
  std::string words;
  if (edit.landmarks > 0) words = counted_words(edit.landmarks, "landmark");
  if (edit.pulls > 0) words += (words.empty() ? "" : " and ") + counted_words(edit.pulls, "pull");
  return words;
}

Result<ShapeView> shape_to(const std::string& what, const Document& document, const std::string& of) {
  if (const auto shown = document.view(of)) return *shown;
  return fail("", "There is no mesh to " + what + "; load a template first.");
}

Result<FitEdit> fit_shape(const ShapeView& shown, const Boundary& boundary, bool as_placed, FitOptions options) {
  if (as_placed) options.placement = shown.shape.placement;
  options.landmarks = shown.shape.landmarks;
  auto fit = fit_to_boundary(shown.the_template(), boundary, options);
  if (!fit) return fail(fit.error());
  FitEdit edit;
  edit.action = points_edit(shown, fit->mesh.points, by_fit, fit->placement);
  edit.action.doubt_mm = doubt_on_grid(fit->doubt_mm);
  if (options.partial) edit.action.outlier = std::make_shared<const VertexScalars>(outlier_marks(*fit));
  edit.result = std::move(*fit);
  return edit;
}

Result<SnapEdit> snap_shape(const Scan& scan, const ShapeView& shown, const std::optional<SnapArea>& region,
                            const SnapOptions& options, SnapHolds holds) {
  if (!scan.image) return fail("", "There is no image to snap to; open one first.");
  const Shape& shape = shown.shape;
  SnapStart start{
      shown.mesh(), *shape.placed, *shown.paint().stiffness, VertexScalars::Ones(shape.points->rows()), {}, {}};
  if (shape.unsnapped) start.rest = *shape.unsnapped;
  if (region) {
    const Topology& topology = *shown.the_template().topology;
    const SurfacePoint at = nearest_on_surface(topology, start.mesh.points, region->at).at;
    start.free =
        gaussian_falloff(topology, *shape.points, at, region->sigma_mm, mean_edge_mm(topology, *shape.points), false);
    start.free = (start.free.array() < least_falloff).select(0, start.free);
  }
  if (const auto confirmed = confirmed_without_landmarks(shown))
    start.free.array() *= (confirmed->array() < 1).cast<double>();
  SnapEdit edit;
  if (holds == SnapHolds::all) hold_pulled(shape, start, edit);
  pin_landmarks(shown, options.edges.reach_mm, start, edit);
  SnapOptions learned = options;
  if (options.edges.polarity == Polarity::automatic && options.edges.appearance == nullptr)
    learned.edges.appearance = appearance_of_frames(scan, shown);
  auto result = snap(*scan.image, shown.frame, start, learned);
  if (!result) return fail(result.error());
  edit.action = points_edit(shown, result->points, by_snap);
  edit.result = std::move(*result);
  edit.result.points = *edit.action.points;
  if (edit.far_landmarks > 0)
    edit.result.warnings.push_back(counted_words(edit.far_landmarks, "placed landmark") +
                                   (edit.far_landmarks == 1 ? " lies" : " lie") +
                                   " farther from the mesh than a snap looks; bring the mesh there with Grab");
  return edit;
}

Result<RefineEdit> refine_shape(const ShapeView& shown, Progress* progress) {
  const Shape& shape = shown.shape;
  RefineStart start{*shape.points,
                    *shape.placed,
                    shape.placement,
                    shape.landmarks,
                    shown.paint().base * *shown.paint().stiffness,
                    {}};
  if (shape.confirmed) start.confirmed = *shape.confirmed;
  const auto refined = refine(shown.the_template(), start, progress);
  if (!refined) return fail(refined.error());
  return RefineEdit{points_edit(shown, refined->points, by_refinement), refined->warnings};
}

}  // namespace homolog
