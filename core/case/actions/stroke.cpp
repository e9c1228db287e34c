#include "core/case/actions/stroke.h"

#include <array>
#include <cstdio>
#include <utility>

#include "core/case/actions/decided.h"
#include "core/case/actions/fields.h"
#include "core/case/held_landmarks.h"
#include "core/deform/stroke_kinds.h"

namespace homolog {

namespace {

constexpr auto tool_names = [] {
  Names<Tool, stroke_kinds.size()> names;
  for (std::size_t k = 0; k < names.size(); ++k) names[k] = {stroke_kinds[k].name, stroke_kinds[k].tool};
  return names;
}();

void spell_stroke(Fields& line, Stroke& stroke) {
  line.member("tool", tool_names, stroke.tool);
  line.member("at", stroke.at);
  if (line.reads()) stroke.to = stroke.at;
  const bool is_dab = kind_of_stroke(stroke.tool).is_dab();
  if (is_dab)
    line.optional("to", stroke.to);
  else
    line.member("to", stroke.to);
  line.member("sigma_mm", stroke.sigma_mm);
  line.optional("on", stroke.on);
  line.optional("through_space", stroke.through_space, stroke.through_space);
  line.optional("strength", stroke.strength, is_dab);
}

/// Why the mesh hardly followed a drag, where something that is held near it is the reason; empty where it followed, or
/// nothing is held.
std::string hold_words(const ShapeView& before, const Stroke& stroke, double moved_mm) {
  constexpr double least_drag_mm = 0.5;
  const StrokeKind& kind = kind_of_stroke(stroke.tool);
  const double dragged_mm = (stroke.to - stroke.at).norm();
  if (kind.is_dab() || dragged_mm < least_drag_mm || moved_mm >= kind.followed_share * dragged_mm) return {};
  const Shape& shape = before.shape;
  if (!shape.confirmed) return {};
  const auto of_mm = [](double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.1f mm", value);
    return std::string(text.data());
  };
  const std::string moved = "The mesh moved " + of_mm(moved_mm) + " of " + of_mm(dragged_mm) + ": ";
  // The nearest vertex that is held, and the landmark that holds it.
  double nearest_mm = stroke.sigma_mm;
  bool any = false;
  for (Eigen::Index v = 0; v < shape.points->rows(); ++v) {
    const double away_mm = (shape.points->row(v).transpose() - stroke.at).norm();
    if ((*shape.confirmed)[v] <= 0.5 || away_mm >= nearest_mm) continue;
    nearest_mm = away_mm;
    any = true;
  }
  if (!any) return {};
  const Template& the_template = before.the_template();
  const auto& landmarks = the_template.landmarks;
  constexpr double same_mm = 5;
  for (std::size_t l = 0; l < landmarks.size(); ++l) {
    const LandmarkHold hold = landmark_hold(the_template, l, shape);
    const double away_mm = (carried_landmark(the_template, l, *shape.points) - stroke.at).norm();
    if (hold.placed && hold.held && away_mm <= nearest_mm + same_mm)
      return moved + "\"" + landmarks[l].name + "\", " + of_mm(away_mm) +
             " away, is held. Its lock in Place releases it.";
  }
  return moved + "confirmed vertices are " + of_mm(nearest_mm) + " away. Alt with Confirm (C) frees them.";
}

Result<EditReport> apply_stroke(const Stroke& stroke, ShapeEdit& edit) {
  const Document& document = edit.document;
  const Shape& shape = edit.before.shape;
  auto outcome = edit.deformer.stroke(stroke_start(document, edit.before), stroke, edit.pass);
  if (!outcome) return fail(outcome.error());
  EditReport report;
  report.stopped_by_guard = outcome->stopped_by_guard;
  report.moved_mm = outcome->moved_mm;
  report.on = outcome->on;
  report.response = outcome->response;
  report.solves = outcome->solves;
  report.message = hold_words(edit.before, stroke, report.moved_mm);
  if (report.stopped_by_guard && report.message.empty()) report.message = "Stopped before a triangle turned over.";
  Shape& after = edit.after;
  if (shape.unaided) {
    // Every stroke of `paper` puts a vertex somewhere.
    const bool absolute = kind_of_stroke(stroke.tool).sets_places || document.scheme == Scheme::paper;
    after.unaided =
        std::make_shared<const Points>(absolute ? unaided_after(*shape.unaided, *shape.points, outcome->points)
                                                : Points(*shape.unaided + outcome->points - *shape.points));
  }
  after.unsnapped.reset();  // who strokes a snapped mesh takes it as it is: the next snap keeps to that shape
  after.points = std::make_shared<const Points>(std::move(outcome->points));
  if (outcome->response) decide(after, outcome->response);
  if (outcome->response && report.moved_mm > 0) note_pull(after, *outcome->response);
  ++after.strokes;
  return report;
}

}  // namespace

const ActionKind<Stroke>& action_kind(const Stroke&) {
  static constexpr ActionKind<Stroke> kind{
      .key = "tool",
      .example = R"({"tool":"pull","at":[-21,20,-9],"to":[-19,17,-9],"sigma_mm":12})",
      .meaning =
          "a stroke with `pull`, `grab` or `slide`: `at` snaps to the nearest surface point, `to` is where the "
          "cursor ended. A pull follows the straight path between them unless `on` names the surface point it "
          "ended on. `\"through_space\":true` lets the falloff reach other sheets. With `\"tool\":\"relax\"`, "
          "`\"strength\":1` and no `to` it is one dab of Relax",
      .role = LineRole::stroke,
      .name = [](const Stroke& stroke) -> std::string { return kind_of_stroke(stroke.tool).name; },
      .spell = spell_stroke,
      .apply = apply_stroke};
  return kind;
}

StrokeStart stroke_start(const Document& document, const ShapeView& shown) {
  const Shape& shape = shown.shape;
  const Paint& paint = shown.paint();
  return {.topology = shown.the_template().topology,
          .placed = shape.placed,
          .reference = shape.reference,
          .points = shape.points,
          .stiffness = paint.stiffness,
          .stiffness_base = paint.base,
          .confirmed = shape.confirmed,
          .scheme = document.scheme,
          .paper_events = document.paper_events,
          .even_spacing = document.even_spacing};
}

}  // namespace homolog
