#pragma once

#include <nlohmann/json.hpp>

#include "core/case/action.h"

namespace homolog {

// The case file's spelling of actions and their values; see docs/case-file.md.

nlohmann::ordered_json to_json(const Action& action);
/// Errors: no known key, or a known key with a value of the wrong kind.
Result<Action> action_from_json(const nlohmann::ordered_json& line);

nlohmann::ordered_json to_json(const Similarity& placement);
Result<Similarity> similarity_from_json(const nlohmann::ordered_json& value);

}  // namespace homolog
