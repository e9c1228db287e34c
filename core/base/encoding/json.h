#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/result.h"

namespace homolog {

/// The one way in which the program reads JSON, as nlohmann::json or nlohmann::ordered_json. Errors: invalid JSON; more
/// than 64 levels of arrays and objects (Homolog writes no more, and the library recurses once for each level); with
/// ordered_json, whose objects are searched from the front, an object of more than 1,000 members; so many arrays or
/// values that they would take many times the text's memory. `what` of the error
/// says which, without a remedy.
template <class Json>
Result<Json> read_json(std::string_view text);

/// The first key that an object of JSON text has twice, of which read_json keeps one value alone; none where there is
/// no such. `text`: one that read_json reads.
std::optional<std::string> doubled_key(std::string_view text);

extern template Result<nlohmann::json> read_json(std::string_view text);
extern template Result<nlohmann::ordered_json> read_json(std::string_view text);

}  // namespace homolog
