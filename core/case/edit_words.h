#pragma once

#include <string>

#include "core/case/action.h"

namespace homolog {

/// Words on what an edit did and where, for lists of edits: "pull 3.2 mm, left", "confirm 10 mm, near lower pole".
/// `shown` is what the edit begins with; without it, and without a place, it is the edit's name [action_name].
std::string edit_words(const Action& action, const std::optional<ShapeView>& shown);

}  // namespace homolog
