#include "core/assist/assist.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>

#include "core/adapt/contours/contour_fit.h"
#include "core/adapt/refine.h"
#include "core/base/text/listed.h"
#include "core/case/held_landmarks.h"
#include "core/deform/falloff.h"
#include "core/mesh/mesh_quality.h"
#include "core/volume/redrawn_contour.h"

namespace homolog {

namespace {

constexpr double least_falloff = 0.05;  ///< share of the falloff: beyond it nothing moves

/// The look of the edited frame nearest to the shown one; null where there is none.
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

/// Whether a person left all corners of a triangle free.
bool is_free(const ShapeView& shown, const SurfacePoint& on, const VertexScalars& free) {
  const auto corners = shown.the_template().topology->triangles().row(on.face);
  return std::all_of(corners.begin(), corners.end(), [&](auto corner) { return free[corner] > 0; });
}

/// Pins the mesh to the placed landmarks that a snap may move it to.
void pin_landmarks(const ShapeView& shown, double reach_mm, SnapStart& start, SnapEdit& edit) {
  const Template& the_template = shown.the_template();
  for (std::size_t l = 0; l < the_template.landmarks.size(); ++l) {
    const LandmarkHold hold = landmark_hold(the_template, l, shown.shape);
    if (!hold.placed) continue;
    if (shown.structure.landmarks.hold && hold.met && !hold.held) continue;  // a person released it
    const SurfacePoint& on = the_template.landmark_points[l];
    if (!is_free(shown, on, start.free)) {
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

/// Pins the mesh to the contours that it lies near enough to.
void pin_contours(const ShapeView& shown, double reach_mm, SnapStart& start, SnapEdit& edit) {
  constexpr double on_it_mm = 1e-6;
  auto drawn = drawn_contours(shown);
  std::erase_if(drawn, [](const DrawnContour& one) { return one.off_mm > 0; });  // a pin is met exactly
  if (drawn.empty()) return;
  std::vector<char> held(drawn.size(), 0);
  for (const Pin& pin : contour_pins(drawn, start.mesh)) {
    const Vec3 from = pin.on.interpolate(*start.mesh.topology, start.mesh.points).transpose();
    if ((pin.place - from).norm() > reach_mm || !is_free(shown, pin.on, start.free)) continue;
    start.pins.push_back(pin);
    for (std::size_t c = 0; c < drawn.size(); ++c)
      if ((nearest_place(drawn[c].curve, pin.place).at - pin.place).norm() < on_it_mm) held[c] = 1;
  }
  edit.contours = static_cast<int>(std::ranges::count(held, 1));
}

void hold_pulled(const Shape& shape, SnapStart& start, SnapEdit& edit) {
  constexpr double noticed = 0.5;
  if (!shape.pulled) return;
  if (((shape.pulled->array() > noticed) && (start.free.array() > 0)).any()) edit.pulls = shape.pulls;
  start.free.array() *= shape.pulled->unaryExpr(&free_share).array();
}

/// Whether most of some curves lie where the mesh is.
bool meets(const Points& points, const std::vector<DrawnContour>& contours) {
  constexpr double beside = 0.1;  // share of the mesh's diagonal
  Box box = bounds_of(points);
  const Vec3 room = Vec3::Constant(beside * box.diagonal().norm());
  box = Box(box.min() - room, box.max() + room);
  std::ptrdiff_t all = 0, there = 0;
  for (const DrawnContour& one : contours) {
    all += std::ssize(one.curve.points);
    there +=
        std::count_if(one.curve.points.begin(), one.curve.points.end(), [&](const Vec3& p) { return box.contains(p); });
  }
  return 2 * there > all;
}

/// Whether curves show an organ from all sides, so that they can place it.
bool are_all_around(const Points& placed, const std::vector<DrawnContour>& contours) {
  constexpr std::size_t fewest_planes = 3, pieces = 400;
  constexpr double most_of_it = 0.6;
  const ContourSamples samples = sampled_contours(contours, pieces);
  return samples.planes.size() >= fewest_planes &&
         samples.diagonal_mm() > most_of_it * bounds_of(placed).diagonal().norm();
}

std::string counted_words(int count, const std::string& one) {
  return std::to_string(count) + " " + one + (count == 1 ? "" : "s");
}

}  // namespace

std::string held_in_words(const SnapEdit& edit) {
  std::vector<std::string> words;
  if (edit.landmarks > 0) words.push_back(counted_words(edit.landmarks, "landmark"));
  if (edit.contours > 0) words.push_back(counted_words(edit.contours, "contour"));
  if (edit.pulls > 0) words.push_back(counted_words(edit.pulls, "pull"));
  return listed(words, " and ");
}

Result<ShapeView> shape_to(const std::string& what, const Document& document, const std::string& of) {
  if (const auto shown = document.view(of)) return *shown;
  return fail("", "There is no mesh to " + what + "; load a template first.");
}

SetPoints edit_of_fit(const ShapeView& shown, const FitResult& fit, bool partial) {
  SetPoints edit = points_edit(shown, fit.mesh.points, FoundBy::fit, fit.placement);
  edit.doubt_mm = doubt_on_grid(fit.doubt_mm);
  if (partial) edit.outlier = std::make_shared<const VertexScalars>(outlier_marks(fit));
  return edit;
}

FitFigures figures_of_fit(const FitJudgement& judgement, const FitResult& fit, bool partial) {
  FitFigures figures;
  figures.mean_mm = partial ? judgement.target.mean_mm : judgement.inside_scan.assd_mm;
  figures.p95_mm = partial ? judgement.target.p95_mm : judgement.inside_scan.hd95_mm;
  if (!partial && !judgement.rim) figures.dice = judgement.inside_scan.dice;
  if (partial)
    figures.missing_share = static_cast<double>(fit.outliers.size()) / static_cast<double>(fit.mesh.points.rows());
  for (const std::string& warning : judgement.warnings) figures.warnings.push_back(as_sentence(warning));
  return figures;
}

Result<FitEdit> fit_shape(const ShapeView& shown, const Boundary& boundary, bool as_placed, FitOptions options) {
  if (as_placed) options.placement = shown.shape.placement;
  options.landmarks = shown.shape.landmarks;
  auto fit = fit_to_boundary(shown.the_template(), boundary, options);
  if (!fit) return fail(fit.error());
  SetPoints action = edit_of_fit(shown, *fit, options.partial);
  return FitEdit{std::move(action), std::move(*fit)};
}

std::vector<DrawnContour> drawn_contours(const ShapeView& shown) {
  std::vector<DrawnContour> drawn;
  for (const auto& set : shown.structure.contours)
    if (set->frame == shown.frame)
      for (const Contour& curve : set->curves) drawn.push_back({curve, set->off_mm, set->outside});
  return drawn;
}

Result<FitEdit> fit_shape_to_contours(const ShapeView& shown, const BetweenContours& between, bool goes_on,
                                      FitOptions options) {
  const auto contours = drawn_contours(shown);
  if (contours.empty()) return fail("", "There is no contour in this frame to fit to; draw one first.");
  if (confirmed_without_landmarks(shown))
    return fail("", "A fit to contours moves every vertex, but some are confirmed; free them first (Place).");
  options.landmarks = shown.shape.landmarks;
  const bool by_contours_alone = shown.shape.strokes == shown.shape.drawn_strokes;
  const bool from_mesh = goes_on && !by_contours_alone && !between.boundary;
  Template the_template = shown.the_template();
  // Few planes do not say how large the organ is.
  options.stays = from_mesh || !are_all_around(*shown.shape.placed, contours);
  if (from_mesh) {
    the_template.landmarks = carried_landmarks(the_template, *shown.shape.points);
    the_template.points = *shown.shape.points;
    options.placement = Similarity{};
  } else if (!options.placement && meets(*shown.shape.points, contours)) {
    options.placement = shown.shape.placement;
  }
  auto fit = between.boundary ? fit_to_contours_and_boundary(the_template, contours, *between.boundary, options)
                              : fit_to_contours(the_template, contours, options);
  if (!fit) return fail(fit.error());
  if (between.image) {
    SnapOptions snapping = between.snap;
    snapping.progress = options.progress;
    SnapStart start{fit->mesh, fit->mesh.points, the_template.stiffness, VertexScalars::Ones(fit->mesh.points.rows())};
    start.pins = contour_pins(contours, fit->mesh);
    const auto snapped = snap(*between.image, shown.frame, start, snapping);
    if (!snapped) return fail(snapped.error());
    fit->mesh.points = snapped->points;
  }
  FitEdit edit;
  // A placement says that it is the template, not the mesh, that went to the contours.
  edit.action = points_edit(shown, fit->mesh.points, FoundBy::contours,
                            from_mesh ? std::nullopt : std::optional<Similarity>(fit->placement));
  if (fit->doubt_mm.size() > 0) edit.action.doubt_mm = doubt_on_grid(fit->doubt_mm);
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
  if (holds == SnapHolds::all) pin_contours(shown, options.edges.reach_mm, start, edit);
  SnapOptions learned = options;
  if (options.edges.polarity == Polarity::automatic && options.edges.appearance == nullptr)
    learned.edges.appearance = appearance_of_frames(scan, shown);
  auto result = snap(*scan.image, shown.frame, start, learned);
  if (!result) return fail(result.error());
  edit.action = points_edit(shown, result->points, FoundBy::snap);
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
  return RefineEdit{points_edit(shown, refined->points, FoundBy::refinement), refined->warnings};
}

}  // namespace homolog
