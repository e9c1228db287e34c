#pragma once

#include <string>

#include "core/case/action.h"

namespace homolog {

/// What an edit did and where, for lists of edits: "pull 3.2 mm, left", "confirm 10 mm, near lower pole". `before` is
/// the document that is edited. Without a place it is the edit's name [action_name].
std::string edit_words(const Action& action, const Document& before);

}  // namespace homolog
