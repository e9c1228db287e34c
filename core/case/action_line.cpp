#include "core/case/action_line.h"

#include "core/base/json.h"
#include "core/case/action_json.h"

namespace homolog {

using Json = nlohmann::ordered_json;

std::string action_line(const Action& action, bool joined) {
  Json json = to_json(action);
  if (joined) json["joined"] = true;
  return dumped(json);
}

Result<EditStep> parse_action(const std::string& line) {
  const auto json = read_json<Json>(line);
  if (!json) return fail(json.error());
  auto action = action_from_json(*json);
  if (!action) return fail(action.error());
  const auto joined = json->find("joined");
  return EditStep{std::move(*action), joined != json->end() && *joined == true};
}

}  // namespace homolog
