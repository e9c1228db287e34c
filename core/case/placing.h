#pragma once

#include "core/case/actions/kind.h"

namespace homolog {

/// Errors: no unit rotation, no positive scale, a translation that is not finite.
Result<void> check_placement(const Similarity& placement);

/// The shape as it is before any edit: the template at the shape's placement.
void start_anew(const Template& the_template, Shape& shape);

/// Before the first stroke, landmarks carry the template along as `fit` says; after it the report says why they do not.
/// `weighs` is Document::weighs_landmarks. Errors: landmarks that collapse the template to nothing.
Result<EditReport> carry_to_landmarks(const Template& the_template, LandmarkPull fit, bool weighs, Shape& shape);

}  // namespace homolog
