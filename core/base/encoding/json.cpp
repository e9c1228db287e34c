#include "core/base/encoding/json.h"

#include <array>
#include <set>
#include <type_traits>
#include <vector>

namespace homolog {

namespace {

constexpr std::size_t deepest = 64;

/// A value takes 16 bytes of memory and more, an array or object 60 and more, so that a file of "[],[],…" would unfold
/// to many times its size. Models hold numbers of some ten characters.
constexpr std::size_t most_containers = 2'000'000;
constexpr std::size_t most_values(std::size_t characters) {
  return 1'000'000 + characters / 4;
}

/// The levels, members and values of JSON text, counted before a value is made of it. Says what is wrong; empty where
/// nothing is. Text that is no JSON is left to the parser: up to its fault both see the same.
std::string excess_of(std::string_view text, std::size_t most_members) {
  const std::size_t values_left = most_values(text.size());
  std::size_t containers = 0, values = 0;
  std::array<std::size_t, deepest + 1> members{};  // members of the object that is open at each level
  std::size_t level = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      in_string = c != '"';
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (level == deepest)
        return "nests its JSON more than " + std::to_string(deepest) + " levels deep, which no file of this kind does";
      members[++level] = 0;
      if (++containers > most_containers)
        return "has more than " + std::to_string(most_containers) +
               " arrays and objects, which no file of this kind has";
    } else if (c == ',') {
      if (++values > values_left) return "has far more values than a file of its kind and size";
    } else if (c == ']' || c == '}') {
      if (level > 0) --level;
    } else if (c == ':' && ++members[level] > most_members) {
      return "has a JSON object of more than " + std::to_string(most_members) +
             " members, which no file of this kind has";
    }
  }
  return {};
}

}  // namespace

template <class Json>
Result<Json> read_json(std::string_view text) {
  constexpr bool searched_from_front = std::is_same_v<Json, nlohmann::ordered_json>;
  if (std::string excess = excess_of(text, searched_from_front ? 1000 : text.size()); !excess.empty())
    return fail("", std::move(excess));
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return fail("", "is no valid JSON (cut short or edited by hand)");
  return json;
}

std::optional<std::string> doubled_key(std::string_view text) {
  using Json = nlohmann::json;
  std::optional<std::string> doubled;
  std::vector<std::set<std::string>> keys;  // of the objects that are open
  const auto see = [&](int, Json::parse_event_t event, Json& value) {
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second && !doubled)
      doubled = value.get<std::string>();
    return !doubled;  // what is left is not needed
  };
  [[maybe_unused]] const Json all = Json::parse(text, see, false);
  return doubled;
}

template Result<nlohmann::json> read_json(std::string_view text);
template Result<nlohmann::ordered_json> read_json(std::string_view text);

}  // namespace homolog
