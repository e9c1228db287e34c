#pragma once

#include "core/case/actions/kind.h"
#include "core/case/members.h"

namespace homolog {

/// Errors: no unit rotation, a scale or a translation that no case needs (or that is no number).
Result<void> check_placement(const Similarity& placement);
/// The same, and a mesh that lies beyond farthest_mm then. `rest`: the template's points.
Result<void> check_placement(const Similarity& placement, const Points& rest);

/// The place of a template that nobody placed: in the middle of the image, upright, at its own size.
Similarity in_the_middle(const Scan& scan, const Template& the_template);

/// The shape as it is before any edit: the template at the shape's placement.
void start_anew(const Template& the_template, Shape& shape);
/// Empties the members that are traces of edits [is_trace]. The points stay.
void forget_edits(Shape& shape);
/// Empties the members whose values come from there.
void forget(Origin origin, Shape& shape);

/// The mesh of a frame; where it has none yet, the one that it begins with: the template at the shown frame's
/// placement.
Shape shape_of_frame(const Structure& structure, int shown_frame, int frame);
/// Errors: a frame that the case's image does not have.
Result<void> check_frame(const Scan& scan, int frame);

/// Before the first stroke, landmarks carry the template along as `fit` says; after it the report says why they do not.
/// Errors: landmarks that collapse the template to nothing.
Result<EditReport> carry_to_landmarks(const Template& the_template, LandmarkPull fit, LandmarkRule rule, Shape& shape);

}  // namespace homolog
