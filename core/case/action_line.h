#pragma once

#include <string>

#include "core/case/action.h"

namespace homolog {

/// One line for an action, without line feed; numbers in the shortest form that reads back to the same double.
std::string action_line(const EditStep& step);
/// Errors: not JSON, no known key, a value of the wrong kind; unknown keys beside known ones are ignored (the file
/// keeps them).
Result<EditStep> parse_action(const std::string& line);

}  // namespace homolog
