#pragma once

#include "app/editor/update/editing.h"

namespace homolog {

/// Makes the model of the study's other cases, and gives the shown mesh to be scored, where somebody looks at the
/// score. True where there is something new to draw.
bool update_scores(Editing& editing);

}  // namespace homolog
