#pragma once

#include "core/adapt/allowed_shapes.h"
#include "core/model/shape_model.h"
#include "core/template/template.h"

namespace homolog {

/// The shapes that a model allows, mean + Φ b with every |b_i| ≤ limit · √λ_i [Erdt 2009, §2.3], for fits of this
/// template. The model's frame is turned, shifted and sized so that its mean lies on the template, whose axes are the
/// patient's. A joint model gives the structure that the template is of: the only one of its numbering, or of several
/// the one that its file is named after. Errors: a model of another vertex count or of other faces; several structures
/// that it could be.
Result<AllowedShapes> allowed_by(const ShapeModel& model, const Template& the_template, double limit = 3);

}  // namespace homolog
