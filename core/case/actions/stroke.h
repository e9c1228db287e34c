#pragma once

#include "core/case/actions/kind.h"
#include "core/deform/stroke.h"

namespace homolog {

// The struct Stroke is the deformer's; here is what it is as an action of a case.
const ActionKind<Stroke>& action_kind(const Stroke&);

/// The start of a stroke on a mesh. `shown` must be of `document`.
StrokeStart stroke_start(const Document& document, const ShapeView& shown);

}  // namespace homolog
