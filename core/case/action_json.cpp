#include "core/case/action_json.h"

#include <utility>
#include <vector>

#include "core/case/actions/fields.h"

namespace homolog {

namespace {

using Json = nlohmann::ordered_json;

template <class A>
Action read_action(const ActionKind<A>& kind, const Json& line) {
  A action;
  Fields members = Fields::reader(line);
  kind.spell(members, action);
  return action;
}

}  // namespace

std::optional<LineRole> role_of_key(std::string_view key) {
  static const auto roles = [] {
    std::vector<std::pair<std::string_view, LineRole>> all;
    for_each_action_kind([&](const auto& kind) { all.emplace_back(kind.key, kind.role); });
    return all;
  }();
  for (const auto& [known, role] : roles)
    if (key == known) return role;
  return std::nullopt;
}

Json to_json(const Action& action) {
  const auto write = [](auto one) {
    Json line = Json::object();
    Fields members = Fields::writer(line);
    action_kind(one).spell(members, one);
    return line;
  };
  return std::visit(write, action);
}

Result<Action> action_from_json(const Json& line) {
  if (!line.is_object()) return fail("", "is not a JSON object");
  std::optional<Result<Action>> read;
  for_each_action_kind([&](const auto& kind) {
    if (!read && line.contains(kind.key)) read = caught([&] { return read_action(kind, line); });
  });
  if (read) return std::move(*read);
  return fail("", "is of no known kind; it may come from a newer version of Homolog");
}

std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json to_json(const Similarity& placement) {
  Json json = Json::object();
  Similarity value = placement;
  Fields::writer(json).similarity(value);
  return json;
}

Result<Similarity> similarity_from_json(const Json& value) {
  return caught([&] {
    Similarity placement;
    Fields::reader(value).similarity(placement);
    return placement;
  });
}

}  // namespace homolog
