#include "core/case/action_line.h"

#include "core/base/encoding/json.h"
#include "core/case/action_json.h"

namespace homolog {

using Json = nlohmann::ordered_json;

std::string action_line(const EditStep& step) {
  Json json = to_json(step.action);
  if (!step.of.empty()) json["of"] = step.of;
  if (step.joined) json["joined"] = true;
  return dumped(json);
}

Result<EditStep> parse_action(const std::string& line) {
  const auto json = read_json<Json>(line);
  if (!json) return fail(json.error());
  auto action = action_from_json(*json);
  if (!action) return fail(action.error());
  const auto joined = json->find("joined"), of = json->find("of");
  EditStep step{std::move(*action), {}, joined != json->end() && *joined == true};
  if (of == json->end()) return step;
  if (!of->is_string()) return fail("", "\"of\" is no structure's id");
  step.of = of->get<std::string>();
  return step;
}

}  // namespace homolog
