#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/case/action.h"
#include "core/case/moved_points.h"
#include "core/case/paint.h"
#include "core/mesh/mirror.h"
#include "core/mesh/surface_search.h"
#include "core/placement/landmark_warp.h"
#include "core/placement/likely_similarity.h"
#include "core/placement/similarity_fit.h"

namespace homolog {

namespace {

bool usable(const Similarity& s) {
  return s.rotation.coeffs().allFinite() && std::abs(s.rotation.norm() - 1) < 1e-6 && std::isfinite(s.scale) &&
         s.scale > 0 && s.translation.allFinite();
}

std::shared_ptr<const Points> share(Points points) {
  return std::make_shared<const Points>(std::move(points));
}

/// Notes how far an edit has decided each vertex, 0 … 1.
void decide(Shape& shape, std::shared_ptr<const VertexScalars> share) {
  shape.decided = shape.decided ? std::make_shared<const VertexScalars>(shape.decided->cwiseMax(*share)) : share;
}

/// The shape without the model's help, after an edit that sets points: a vertex that the edit moved is where the edit
/// put it.
Points unaided_after(const Points& unaided, const Points& from, const Points& to) {
  Points after = unaided;
  for (Eigen::Index i = 0; i < after.rows(); ++i)
    if (from.row(i) != to.row(i)) after.row(i) = to.row(i);
  return after;
}

/// The shape as it is before any edit: template, placement, and the warp where landmarks ask for it. Gives a sentence
/// where the warp could not be followed.
std::string start_anew(const Template& reference, LandmarkFit fit, const Points& from, const Points& to, Shape& shape) {
  std::string message;
  shape.placed = share(shape.placement.apply(reference.points));
  shape.reference = shape.placed;
  if (fit == LandmarkFit::warp) {
    WarpedReference warped = warp_to_landmarks(*reference.topology, *shape.placed, shape.placement.apply(from), to);
    if (warped.share > 0) shape.reference = share(std::move(warped.points));
    if (warped.folds)
      message =
          "The landmarks would fold the mesh, so the mesh does not quite meet them. Check that each is in its place.";
  }
  shape.points = shape.reference;
  shape.decided.reset();
  shape.unaided.reset();
  shape.strokes = 0;
  return message;
}

/// Before the first stroke, landmarks carry the template along. Errors: landmarks that collapse it to nothing.
Result<EditReport> follow_landmarks(const Template& reference, LandmarkFit fit, bool weighs, Shape& shape) {
  EditReport report;
  if (fit == LandmarkFit::off) return report;
  if (shape.strokes > 0) {
    report.message =
        "After the first stroke landmarks no longer move the mesh. Bring the mesh to them with Slide or Grab.";
    return report;
  }
  const auto [from, to] = matched_landmarks(reference, shape.landmarks);
  if (from.rows() == 0) return report;
  const Similarity placement =
      weighs ? likely_similarity(from, to, {shape.before_landmarks}, bounds_of(reference.points).diagonal().norm())
             : fit_similarity(from, to, shape.placement);
  if (!usable(placement) || placement.scale < 1e-3) {
    return fail("landmarks", "contradict each other, so that the template would shrink to nothing; check their places");
  }
  shape.placement = placement;
  report.message = start_anew(reference, fit, from, to, shape);
  return report;
}

/// R and P move along with the placement.
void move_placement(const Template& reference, const Similarity& placement, Shape& shape) {
  const Similarity move = placement.after(shape.placement.inverse());
  const bool warped = shape.reference != shape.placed;
  const bool edited = shape.points != shape.reference;
  if (shape.unaided) shape.unaided = share(move.apply(*shape.unaided));
  shape.placement = shape.before_landmarks = placement;
  shape.placed = share(placement.apply(reference.points));
  shape.reference = warped ? share(move.apply(*shape.reference)) : shape.placed;
  shape.points = edited ? share(move.apply(*shape.points)) : shape.reference;
}

/// One function per action; each returns what changed as a new document.
struct Updater {
  const Document& before;
  Deformer& deformer;
  Pass pass;

  Result<void> needs_shape() const {
    if (before.reference == nullptr) return fail("", "There is no template yet; load one first.");
    if (!before.has_shape()) return fail("", "This frame has no mesh yet; start it from another frame.");
    return {};
  }
  static Result<Updated> done(Document document, EditReport report = {}) {
    return Updated{std::move(document), std::move(report)};
  }
  Shape& shape_of(Document& document) const { return document.shapes.at(document.frame); }

  Result<Updated> operator()(const Stroke& stroke) const {
    if (auto ready = needs_shape(); !ready) return fail(ready.error());
    const Shape& shape = before.shape();
    const StrokeStart start{before.reference->topology, shape.placed,          shape.reference, shape.points,
                            before.stiffness,           before.stiffness_base, shape.confirmed, before.scheme,
                            before.paper_events,        before.spacing};
    auto outcome = deformer.stroke(start, stroke, pass);
    if (!outcome) return fail(outcome.error());
    EditReport report;
    report.stopped_by_guard = outcome->stopped_by_guard;
    report.moved_mm = outcome->moved_mm;
    report.on = outcome->on;
    report.response = outcome->response;
    report.solves = outcome->solves;
    if (report.stopped_by_guard) report.message = "Stopped before a triangle turned over.";
    Document after = before;
    if (shape.unaided) {
      // Relax, and every stroke of `paper`, put a vertex somewhere; other strokes carry it by a distance.
      const bool absolute = stroke.tool == Tool::relax || before.scheme == Scheme::paper;
      shape_of(after).unaided = share(absolute ? unaided_after(*shape.unaided, *shape.points, outcome->points)
                                               : Points(*shape.unaided + outcome->points - *shape.points));
    }
    shape_of(after).points = share(std::move(outcome->points));
    if (outcome->response) decide(shape_of(after), outcome->response);
    ++shape_of(after).strokes;
    return done(std::move(after), std::move(report));
  }

  Result<Updated> operator()(const SetPlacement& action) const {
    if (auto ready = needs_shape(); !ready) return fail(ready.error());
    if (!usable(action.placement)) return fail("placement", "is not a rotation, a positive scale and a translation");
    Document after = before;
    move_placement(*before.reference, action.placement, shape_of(after));
    return done(std::move(after));
  }

  /// Every action that paints.
  template <class Paint>
  requires requires(const Document& document, const Paint& action) { painted(document, action); }
  Result<Updated> operator()(const Paint& action) const {
    if (auto ready = needs_shape(); !ready) return fail(ready.error());
    auto result = painted(before, action);
    if (!result) return fail(result.error());
    Document after = before;
    after.stiffness = std::move(result->stiffness);
    after.regions = std::move(result->regions);
    EditReport report;
    if (result->touched > 0) report.message = std::to_string(result->touched) + " vertices painted.";
    return done(std::move(after), std::move(report));
  }

  Result<Updated> operator()(const SetPoints& action) const {
    if (auto ready = needs_shape(); !ready) return fail(ready.error());
    if (!action.points || action.points->rows() != before.reference->points.rows()) {
      return fail("points", std::to_string(action.points ? action.points->rows() : 0) + " were given for " +
                                std::to_string(before.reference->points.rows()) + " vertices");
    }
    if (!action.points->allFinite()) return fail("points", "hold a coordinate that is no finite number");
    if (action.placement && !usable(*action.placement))
      return fail("placement", "is not a rotation, a positive scale and a translation");
    Document after = before;
    Shape& shape = shape_of(after);
    if (action.placement) {
      shape.placement = shape.before_landmarks = *action.placement;
      shape.reference = shape.placed = share(action.placement->apply(before.reference->points));
    }
    if (action.by == by_model) {
      Points unaided = unaided_points(shape);
      const bool taken_back = (unaided - *action.points).cwiseAbs().maxCoeff() <= 1 / steps_per_mm;
      shape.unaided = taken_back ? nullptr : share(std::move(unaided));
    } else if (shape.unaided && action.by == by_refinement) {
      shape.unaided = share(*shape.unaided + *action.points - *shape.points);
    } else if (shape.unaided) {
      Points unaided = unaided_after(*shape.unaided, *shape.points, *action.points);
      shape.unaided = unaided == *action.points ? nullptr : share(std::move(unaided));
    }
    if (action.by != by_model && action.by != by_refinement) {
      const auto moved_mm2 = (*action.points - *shape.points).rowwise().squaredNorm().array();
      decide(shape, std::make_shared<const VertexScalars>((moved_mm2 > 0).cast<double>()));
    }
    shape.points = action.points;
    ++shape.strokes;
    return done(std::move(after));
  }

  Result<Updated> operator()(const MovePoints& action) const {
    if (auto ready = needs_shape(); !ready) return fail(ready.error());
    const auto points = points_of(*before.shape().points, action);
    return points ? (*this)(*points) : fail(points.error());
  }

  Result<Updated> operator()(const SetStiffnessBase& action) const {
    if (!(action.base > 0) || !std::isfinite(action.base)) return fail("stiffness", "must be positive");
    Document after = before;
    after.stiffness_base = action.base;
    return done(std::move(after));
  }

  Result<Updated> operator()(const Confirm& action) const {
    if (auto ready = needs_shape(); !ready) return fail(ready.error());
    if (!(action.radius_mm > 0) || !action.at.allFinite()) return fail("confirm", "needs a positive radius");
    const auto& held = before.shape().confirmed;
    auto confirmed = held ? std::make_shared<VertexScalars>(*held)
                          : std::make_shared<VertexScalars>(VertexScalars::Zero(before.stiffness->size()));
    const int touched = brush(*before.shape().points, action.at, action.radius_mm, 0,
                              [&](Eigen::Index i, double) { (*confirmed)[i] = action.hold ? 1 : 0; });
    Document after = before;
    shape_of(after).confirmed = confirmed->any() ? confirmed : nullptr;
    EditReport report;
    report.message = std::to_string(touched) + (action.hold ? " vertices confirmed." : " vertices released.");
    return done(std::move(after), std::move(report));
  }

  Result<Updated> operator()(const SetScheme& action) const {
    if (action.paper_events < 1 || action.paper_events > 1000) return fail("events", "must be 1 to 1,000");
    Document after = before;
    after.scheme = action.scheme;
    after.paper_events = action.paper_events;
    return done(std::move(after));
  }

  Result<Updated> operator()(const SetSpacing& action) const {
    if (!(action.strength >= 0 && action.strength <= 1)) return fail("spacing", "must be between 0 and 1");
    Document after = before;
    after.spacing = action.strength;
    return done(std::move(after));
  }

  Result<Updated> operator()(const SetTemplateLandmark& action) const {
    if (auto ready = needs_shape(); !ready) return fail(ready.error());
    if (action.name.empty() || (action.at && !action.at->allFinite()))
      return fail("landmark", "needs a name and a finite position");
    MeshFile file = to_mesh_file(*before.reference);
    const auto known = std::find_if(file.landmarks.begin(), file.landmarks.end(),
                                    [&](const Landmark& landmark) { return landmark.name == action.name; });
    if (action.at) {
      const SurfacePoint on = nearest_on_surface(*before.reference->topology, *before.shape().points, *action.at).at;
      const Vec3 position = on.interpolate(*before.reference->topology, before.reference->points).transpose();
      if (known != file.landmarks.end())
        known->position = position;
      else
        file.landmarks.push_back({action.name, position});
    } else {
      if (known == file.landmarks.end())
        return fail("landmark", "\"" + excerpt(action.name) + "\" is none of the template's");
      file.landmarks.erase(known);
    }
    Document after = before;
    after.reference = with_landmarks(*before.reference, std::move(file.landmarks));
    return done(std::move(after));
  }

  Result<Updated> operator()(const PlaceLandmark& action) const {
    if (auto ready = needs_shape(); !ready) return fail(ready.error());
    if (action.name.empty() || (action.at && !action.at->allFinite())) {
      return fail("landmark", "needs a name and a finite position");
    }
    Document after = before;
    Shape& shape = shape_of(after);
    if (action.at) {
      shape.landmarks.insert_or_assign(action.name, *action.at);
    } else {
      shape.landmarks.erase(action.name);
    }
    auto report = follow_landmarks(*before.reference, before.landmark_fit, before.weighs_landmarks, shape);
    if (!report) return fail(report.error());
    return done(std::move(after), std::move(*report));
  }

  Result<Updated> operator()(const SetLandmarkFit& action) const {
    if (auto ready = needs_shape(); !ready) return fail(ready.error());
    Document after = before;
    after.landmark_fit = action.fit;
    Shape& shape = shape_of(after);
    if (shape.strokes == 0) start_anew(*before.reference, LandmarkFit::off, {}, {}, shape);
    auto report = follow_landmarks(*before.reference, action.fit, before.weighs_landmarks, shape);
    if (!report) return fail(report.error());
    return done(std::move(after), std::move(*report));
  }

  Result<Updated> operator()(const MirrorTemplate&) const {
    if (auto ready = needs_shape(); !ready) return fail(ready.error());
    auto other_side = mirrored(to_mesh_file(*before.reference));
    auto made = make_template(std::move(other_side), before.reference->source);
    if (!made) return fail(made.error());
    Document after = before;
    after.reference = *made;
    for (auto& [frame, shape] : after.shapes) {
      shape.confirmed.reset();
      start_anew(**made, LandmarkFit::off, {}, {}, shape);
      if (auto report = follow_landmarks(**made, before.landmark_fit, before.weighs_landmarks, shape); !report)
        return fail(report.error());
    }
    return done(std::move(after));
  }

  Result<void> check_frame(int frame) const {
    const int frames = before.volume ? before.volume->frames : 1;
    if (frame >= 0 && frame < frames) return {};
    return fail("frame",
                std::to_string(frame) + " does not exist; the volume has frames 0 to " + std::to_string(frames - 1));
  }

  Result<Updated> operator()(const SetFrame& action) const {
    if (auto in_range = check_frame(action.frame); !in_range) return fail(in_range.error());
    Document after = before;
    after.frame = action.frame;
    if (before.reference && !after.has_shape()) {
      Shape shape;
      shape.placement = shape.before_landmarks = before.has_shape() ? before.shape().placement : Similarity{};
      start_anew(*before.reference, LandmarkFit::off, {}, {}, shape);
      after.shapes.emplace(after.frame, std::move(shape));
    }
    return done(std::move(after));
  }

  Result<Updated> operator()(const StartFrameFrom& action) const {
    const auto from = before.shapes.find(action.frame);
    if (from == before.shapes.end()) {
      return fail("frame", std::to_string(action.frame) + " has no mesh to start from");
    }
    Document after = before;
    Shape begun = from->second;
    begun.decided.reset();  // what was decided there is a guess here, and so is what a model did
    begun.unaided.reset();
    after.shapes.insert_or_assign(after.frame, std::move(begun));
    return done(std::move(after));
  }

  Result<Updated> operator()(const Note&) const { return done(before); }
  Result<Updated> operator()(const Undo&) const { return fail("undo", "belongs to the session"); }
  Result<Updated> operator()(const Redo&) const { return fail("redo", "belongs to the session"); }
};

}  // namespace

Result<Updated> update(const Document& document, const Action& action, Deformer& deformer, Pass pass) {
  return std::visit(Updater{document, deformer, pass}, action);
}

SetPoints points_edit(const Document& document, const Points& points, std::string by,
                      const std::optional<Similarity>& placement) {
  Points rounded = *document.shape().points;
  for (Eigen::Index k = 0; k < rounded.size(); ++k)
    if (const double to = points.data()[k]; to != rounded.data()[k]) rounded.data()[k] = on_grid(to);
  return {std::move(by), placement, std::make_shared<const Points>(std::move(rounded))};
}

std::string action_name(const Action& action) {
  struct Namer {
    std::string operator()(const Stroke& stroke) const {
      constexpr const char* names[] = {"pull", "grab", "slide", "relax"};
      return names[static_cast<int>(stroke.tool)];
    }
    std::string operator()(const SetPlacement&) const { return "placement"; }
    std::string operator()(const PaintStiffness&) const { return "stiffness brush"; }
    std::string operator()(const SmoothStiffness&) const { return "smoothing of the stiffness"; }
    std::string operator()(const PaintRegion& paint) const {
      return paint.name.empty() ? std::string("painting away") : "painting of " + paint.name;
    }
    std::string operator()(const FillRegion& fill) const {
      return fill.name.empty() ? std::string("emptying") : "filling of " + fill.name;
    }
    std::string operator()(const SetRegion& set) const { return "region " + set.region.name; }
    std::string operator()(const RenameRegion& rename) const { return "renaming to " + rename.to; }
    std::string operator()(const RemoveRegion& remove) const { return "removal of " + remove.name; }
    std::string operator()(const SetStiffnessFactors&) const { return "imported stiffness"; }
    std::string operator()(const SetTemplateLandmark& landmark) const { return "template landmark " + landmark.name; }
    std::string operator()(const SetPoints& set) const { return set.by.empty() ? "points" : set.by; }
    std::string operator()(const MovePoints& set) const { return set.by.empty() ? "points" : set.by; }
    std::string operator()(const SetStiffnessBase&) const { return "stiffness"; }
    std::string operator()(const Confirm& confirm) const { return confirm.hold ? "confirm" : "release"; }
    std::string operator()(const SetScheme&) const { return "scheme"; }
    std::string operator()(const SetSpacing&) const { return "even spacing"; }
    std::string operator()(const PlaceLandmark& landmark) const { return "landmark " + landmark.name; }
    std::string operator()(const SetLandmarkFit&) const { return "landmark fit"; }
    std::string operator()(const MirrorTemplate&) const { return "mirror"; }
    std::string operator()(const SetFrame&) const { return "frame"; }
    std::string operator()(const StartFrameFrom&) const { return "copy of a frame"; }
    std::string operator()(const Note&) const { return "note"; }
    std::string operator()(const Undo&) const { return "undo"; }
    std::string operator()(const Redo&) const { return "redo"; }
  };
  return std::visit(Namer{}, action);
}

}  // namespace homolog
