#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "core/case/action.h"

namespace homolog {

// The case file's spelling of actions and their values; see docs/case-file.md.

/// The role of a line with this key in the history; none where the key is no action's.
std::optional<LineRole> role_of_key(std::string_view key);

nlohmann::ordered_json to_json(const Action& action);
/// Errors: no known key, or a known key with a value of the wrong kind.
Result<Action> action_from_json(const nlohmann::ordered_json& line);

/// A line of the file; bytes that are no UTF-8 (a path of another encoding) become a replacement character.
std::string dumped(const nlohmann::ordered_json& json);

nlohmann::ordered_json to_json(const Similarity& placement);
Result<Similarity> similarity_from_json(const nlohmann::ordered_json& value);

}  // namespace homolog
