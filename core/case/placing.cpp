#include "core/case/placing.h"

#include <cmath>
#include <utility>

#include "core/base/numbers/limits.h"
#include "core/placement/landmark_warp.h"
#include "core/placement/likely_similarity.h"
#include "core/placement/similarity_fit.h"

namespace homolog {

namespace {

constexpr double smallest_scale = 1e-6, largest_scale = 1e6;

bool usable(const Similarity& s) {
  return s.rotation.coeffs().allFinite() && std::abs(s.rotation.norm() - 1) < 1e-6 && s.scale >= smallest_scale &&
         s.scale <= largest_scale && all_in_reach(s.translation);
}

/// Warps a shape that is as before any edit. Gives a sentence where the warp could not be followed.
std::string warp(const Template& the_template, const Points& from, const Points& to, LandmarkRule rule, Shape& shape) {
  const double diagonal_mm = bounds_of(*shape.placed).diagonal().norm();
  const WarpLengths lengths =
      rule == LandmarkRule::by_size ? warp_lengths(diagonal_mm) : older_warp_lengths(diagonal_mm);
  WarpedReference warped =
      warp_to_landmarks(*the_template.topology, *shape.placed, shape.placement.apply(from), to, lengths);
  if (warped.share > 0) shape.points = shape.reference = std::make_shared<const Points>(std::move(warped.points));
  return warped.folds ? "The mesh does not reach all landmarks, because it would fold. Check the place of each "
                        "landmark."
                      : "";
}

}  // namespace

Result<void> check_placement(const Similarity& placement) {
  if (usable(placement)) return {};
  return fail(
      "placement",
      "is not a rotation, a scale between 0.000001 and 1,000,000 and a translation of at most 1,000,000,000 mm");
}

Result<void> check_placement(const Similarity& placement, const Points& rest) {
  if (auto possible = check_placement(placement); !possible) return possible;
  if (all_in_reach(placement.apply(rest))) return {};
  return fail("placement", std::string("brings the mesh to a place that ") + beyond_farthest);
}

Similarity in_the_middle(const Scan& scan, const Template& the_template) {
  Similarity placement;
  if (scan.image)
    placement.translation = scan.image->geometry.bounds_mm().center() - bounds_of(the_template.points).center();
  return placement;
}

Result<void> check_frame(const Scan& scan, int frame) {
  const int frames = scan.frames();
  if (frame >= 0 && frame < frames) return {};
  return fail("frame",
              std::to_string(frame) + " does not exist; the volume has frames 0 to " + std::to_string(frames - 1));
}

Shape shape_of_frame(const Structure& structure, int shown_frame, int frame) {
  if (const Shape* there = structure.shape(frame)) return *there;
  Shape shape;
  const Shape* shown = structure.shape(shown_frame);
  shape.placement = shape.before_landmarks = shown != nullptr ? shown->placement : Similarity{};
  start_anew(*structure.the_template, shape);
  return shape;
}

void start_anew(const Template& the_template, Shape& shape) {
  shape.placed = std::make_shared<const Points>(shape.placement.apply(the_template.points));
  shape.points = shape.reference = shape.placed;
  forget_edits(shape);
}

void forget_edits(Shape& shape) {
  for_each_member(shape_members, [&](const auto& member) {
    if (is_trace(member.origin)) shape.*member.of = {};
  });
}

void forget(Origin origin, Shape& shape) {
  for_each_member(shape_members, [&](const auto& member) {
    if (member.origin == origin) shape.*member.of = {};
  });
}

Result<EditReport> carry_to_landmarks(const Template& the_template, LandmarkPull fit, LandmarkRule rule, Shape& shape) {
  EditReport report;
  if (fit == LandmarkPull::off) return report;
  if (shape.strokes > 0) {
    report.message =
        "Once the mesh was edited or fitted, landmarks no longer move it. Bring it to them with Slide or Grab.";
    return report;
  }
  const auto [from, to] = matched_landmarks(the_template, shape.landmarks);
  if (from.rows() == 0) return report;
  const Similarity placement =
      rule != LandmarkRule::closed_form
          ? likely_similarity(from, to, {shape.before_landmarks}, bounds_of(the_template.points).diagonal().norm())
          : nearest_similarity(from, to, shape.placement);
  if (!usable(placement) || placement.scale < 1e-3) {
    return fail("landmarks", "contradict each other, so that the template would shrink to nothing; check their places");
  }
  shape.placement = placement;
  start_anew(the_template, shape);
  if (fit == LandmarkPull::warp) report.message = warp(the_template, from, to, rule, shape);
  return report;
}

}  // namespace homolog
