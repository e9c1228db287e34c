#include "core/case/action_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <utility>
#include <vector>

#include "core/base/json.h"
#include "core/base/text.h"

#include "core/case/action_line.h"
#include "core/case/packed.h"

namespace homolog {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::pair<const char*, Tool>, 4> tool_names{
    {{"pull", Tool::pull}, {"grab", Tool::grab}, {"slide", Tool::slide}, {"relax", Tool::relax}}};
constexpr std::array<std::pair<const char*, Scheme>, 3> scheme_names{
    {{"anchored", Scheme::anchored}, {"paper", Scheme::paper}, {"raw", Scheme::raw}}};
constexpr std::array<std::pair<const char*, FillRegion::By>, 2> fill_names{
    {{"region", FillRegion::By::region}, {"curvature", FillRegion::By::curvature}}};
constexpr std::array<std::pair<const char*, LandmarkFit>, 3> fit_names{
    {{"off", LandmarkFit::off}, {"similarity", LandmarkFit::similarity}, {"warp", LandmarkFit::warp}}};

template <class Names, class Value>
const char* name_of(const Names& names, Value value) {
  for (const auto& [name, known] : names) {
    if (known == value) return name;
  }
  return "";
}

// Reading throws, as the JSON library does; action_from_json turns what is thrown into an Error.
struct Unreadable {
  std::string what;
};

template <class Names>
auto named(const Names& names, const Json& value) {
  const std::string given = value.get<std::string>();
  std::string known_names;
  for (const auto& [name, known] : names) {
    if (given == name) return known;
    known_names += std::string(known_names.empty() ? "" : ", ") + name;
  }
  throw Unreadable{"\"" + excerpt(given) + "\" is not one of " + known_names};
}

int integer(const Json& value) {
  if (!value.is_number_integer()) throw Unreadable{excerpt(value.dump()) + " is not a whole number"};
  const auto number = value.get<std::int64_t>();
  if (number < 0 || number > 1000000) throw Unreadable{excerpt(value.dump()) + " is out of range"};
  return static_cast<int>(number);
}

Action when_true(const Json& value, Action action) {
  if (value != true) throw Unreadable{"\"undo\" and \"redo\" take true"};
  return action;
}

Json json_of(const Vec3& p) {
  return Json::array({p[0], p[1], p[2]});
}

Vec3 point(const Json& object, const char* key) {
  const Json& value = object.at(key);
  if (!value.is_array() || value.size() != 3) throw Unreadable{std::string("\"") + key + "\" is not [x,y,z]"};
  return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}

Similarity similarity(const Json& value) {
  const Json& q = value.at("rotation");
  if (!q.is_array() || q.size() != 4) throw Unreadable{"\"rotation\" is not [w,x,y,z]"};
  Similarity s;
  s.rotation = Eigen::Quaterniond(q[0].get<double>(), q[1].get<double>(), q[2].get<double>(), q[3].get<double>());
  if (!(s.rotation.norm() > 1e-6)) throw Unreadable{"\"rotation\" is zero"};
  // A quaternion that is unit to the last digits is taken as it is, so that what was written reads back the same.
  if (std::abs(s.rotation.norm() - 1) > 1e-9) s.rotation.normalize();
  s.scale = value.at("scale").get<double>();
  s.translation = point(value, "translation");
  return s;
}

Action stroke(const Json& line) {
  Stroke s;
  s.tool = named(tool_names, line.at("tool"));
  s.at = point(line, "at");
  s.to = s.tool == Tool::relax && !line.contains("to") ? s.at : point(line, "to");
  s.sigma_mm = line.at("sigma_mm").get<double>();
  if (line.contains("on")) s.on = point(line, "on");
  s.through_space = line.value("through_space", false);
  s.strength = line.value("strength", 1.0);
  return s;
}

Action stiffness(const Json& value) {
  return PaintStiffness{point(value, "at"), value.at("radius_mm").get<double>(), value.at("value").get<double>(),
                        value.value("soft", 0.0)};
}

Action smooth_stiffness(const Json& value) {
  return SmoothStiffness{point(value, "at"), value.at("radius_mm").get<double>(), value.value("strength", 0.5)};
}

Action paint_region(const Json& value) {
  return PaintRegion{value.at("name").get<std::string>(), point(value, "at"), value.at("radius_mm").get<double>(),
                     value.value("soft", 0.0)};
}

Action fill_region(const Json& value) {
  return FillRegion{value.at("name").get<std::string>(), point(value, "at"), named(fill_names, value.at("by")),
                    value.value("tolerance_per_mm", FillRegion{}.tolerance_per_mm)};
}

Action region(const Json& value) {
  const auto colour = colour_from_hex(value.at("colour").get<std::string>());
  if (!colour) throw Unreadable{"\"colour\" is not \"#rrggbb\""};
  return SetRegion{{value.at("name").get<std::string>(), value.at("factor").get<double>(), *colour}};
}

Action stiffness_factors(const Json& value) {
  const auto factors = value.get<std::vector<double>>();
  return SetStiffnessFactors{std::make_shared<const VertexScalars>(
      Eigen::Map<const VertexScalars>(factors.data(), static_cast<Eigen::Index>(factors.size())))};
}

Action points(const Json& value, const Json& line) {
  const auto numbers = value.get<std::vector<double>>();
  if (numbers.size() % 3 != 0) throw Unreadable{"\"points\" is not x, y, z of every vertex"};
  SetPoints set;
  set.by = line.value("by", "");
  if (line.contains("placement")) set.placement = similarity(line.at("placement"));
  set.points = std::make_shared<const Points>(
      Eigen::Map<const Points>(numbers.data(), static_cast<Eigen::Index>(numbers.size() / 3), 3));
  return set;
}

Action moves(const Json& value, const Json& line) {
  constexpr std::int64_t most_landmarks = 1 << 27;
  const auto landmarks = value.at("landmarks").get<std::int64_t>();
  if (landmarks < 1 || landmarks > most_landmarks) throw Unreadable{"\"landmarks\" is out of range"};
  auto steps =
      unpacked<std::uint32_t>(value.at("steps").get_ref<const std::string&>(), 3 * static_cast<std::size_t>(landmarks));
  if (!steps) throw Unreadable{steps.error().what};
  MovePoints move;
  move.by = line.value("by", "");
  if (line.contains("placement")) move.placement = similarity(line.at("placement"));
  move.moves = std::make_shared<const std::vector<std::uint32_t>>(std::move(*steps));
  return move;
}

Action template_landmark(const Json& value) {
  SetTemplateLandmark named{value.at("name").get<std::string>(), {}};
  if (value.contains("at") && !value.at("at").is_null()) named.at = point(value, "at");
  return named;
}

Action confirm(const Json& value) {
  return Confirm{point(value, "at"), value.at("radius_mm").get<double>(), value.value("hold", true)};
}

Action landmark(const Json& value) {
  PlaceLandmark placed{value.at("name").get<std::string>(), {}};
  if (value.contains("at") && !value.at("at").is_null()) placed.at = point(value, "at");
  return placed;
}

/// Every line is known by one key; the first one found decides.
struct Spelling {
  const char* key;
  Action (*read)(const Json& value, const Json& line);
};
const Spelling spellings[] = {
    {"tool", [](const Json&, const Json& line) { return stroke(line); }},
    {"points", points},
    {"moved", moves},
    {"placement", [](const Json& value, const Json&) -> Action { return SetPlacement{similarity(value)}; }},
    {"stiffness", [](const Json& value, const Json&) { return stiffness(value); }},
    {"smooth_stiffness", [](const Json& value, const Json&) { return smooth_stiffness(value); }},
    {"paint_region", [](const Json& value, const Json&) { return paint_region(value); }},
    {"fill_region", [](const Json& value, const Json&) { return fill_region(value); }},
    {"region", [](const Json& value, const Json&) { return region(value); }},
    {"rename_region",
     [](const Json& value, const Json&) -> Action {
       return RenameRegion{value.at("name").get<std::string>(), value.at("to").get<std::string>()};
     }},
    {"remove_region", [](const Json& value, const Json&) -> Action { return RemoveRegion{value.get<std::string>()}; }},
    {"stiffness_factors", [](const Json& value, const Json&) { return stiffness_factors(value); }},
    {"template_landmark", [](const Json& value, const Json&) { return template_landmark(value); }},
    {"stiffness_base", [](const Json& value, const Json&) -> Action { return SetStiffnessBase{value.get<double>()}; }},
    {"confirm", [](const Json& value, const Json&) { return confirm(value); }},
    {"scheme",
     [](const Json& value, const Json& line) -> Action {
       return SetScheme{named(scheme_names, value), line.contains("events") ? integer(line.at("events")) : 1};
     }},
    {"spacing", [](const Json& value, const Json&) -> Action { return SetSpacing{value.get<double>()}; }},
    {"landmark", [](const Json& value, const Json&) { return landmark(value); }},
    {"landmark_fit", [](const Json& value, const Json&) -> Action { return SetLandmarkFit{named(fit_names, value)}; }},
    {"mirror",
     [](const Json& value, const Json&) -> Action {
       if (value != "sagittal") throw Unreadable{"\"mirror\" is not \"sagittal\""};
       return MirrorTemplate{};
     }},
    {"frame",
     [](const Json& value, const Json& line) -> Action {
       return SetFrame{integer(value), !line.value("look", false)};
     }},
    {"start_frame_from", [](const Json& value, const Json&) -> Action { return StartFrameFrom{integer(value)}; }},
    {"note", [](const Json& value, const Json&) -> Action { return Note{value.get<std::string>()}; }},
    {"undo", [](const Json& value, const Json&) { return when_true(value, Undo{}); }},
    {"redo", [](const Json& value, const Json&) { return when_true(value, Redo{}); }},
};

struct Writer {
  Json operator()(const Stroke& s) const {
    Json line{
        {"tool", name_of(tool_names, s.tool)}, {"at", json_of(s.at)}, {"to", json_of(s.to)}, {"sigma_mm", s.sigma_mm}};
    if (s.on) line["on"] = json_of(*s.on);
    if (s.through_space) line["through_space"] = true;
    if (s.tool == Tool::relax) line["strength"] = s.strength;
    return line;
  }
  Json operator()(const SetPlacement& a) const { return {{"placement", to_json(a.placement)}}; }
  Json operator()(const PaintStiffness& a) const {
    return {{"stiffness", {{"at", json_of(a.at)}, {"radius_mm", a.radius_mm}, {"value", a.value}, {"soft", a.soft}}}};
  }
  Json operator()(const SmoothStiffness& a) const {
    return {{"smooth_stiffness", {{"at", json_of(a.at)}, {"radius_mm", a.radius_mm}, {"strength", a.strength}}}};
  }
  Json operator()(const PaintRegion& a) const {
    return {{"paint_region", {{"name", a.name}, {"at", json_of(a.at)}, {"radius_mm", a.radius_mm}, {"soft", a.soft}}}};
  }
  Json operator()(const FillRegion& a) const {
    Json fill{{"name", a.name}, {"at", json_of(a.at)}, {"by", name_of(fill_names, a.by)}};
    if (a.by == FillRegion::By::curvature) fill["tolerance_per_mm"] = a.tolerance_per_mm;
    return {{"fill_region", std::move(fill)}};
  }
  Json operator()(const SetRegion& a) const {
    return {{"region", {{"name", a.region.name}, {"factor", a.region.factor}, {"colour", hex_of(a.region.colour)}}}};
  }
  Json operator()(const RenameRegion& a) const { return {{"rename_region", {{"name", a.name}, {"to", a.to}}}}; }
  Json operator()(const RemoveRegion& a) const { return {{"remove_region", a.name}}; }
  Json operator()(const SetStiffnessFactors& a) const {
    return {{"stiffness_factors", std::vector(a.factors->begin(), a.factors->end())}};
  }
  Json operator()(const SetPoints& a) const {
    Json line{{"points", std::vector(a.points->data(), a.points->data() + a.points->size())}, {"by", a.by}};
    if (a.placement) line["placement"] = to_json(*a.placement);
    return line;
  }
  Json operator()(const MovePoints& a) const {
    Json line{{"by", a.by}};
    if (a.placement) line["placement"] = to_json(*a.placement);
    line["moved"] = {{"landmarks", a.moves->size() / 3}, {"steps", packed<std::uint32_t>(*a.moves)}};
    return line;
  }
  Json operator()(const SetTemplateLandmark& a) const {
    return {{"template_landmark", {{"name", a.name}, {"at", a.at ? json_of(*a.at) : Json()}}}};
  }
  Json operator()(const SetStiffnessBase& a) const { return {{"stiffness_base", a.base}}; }
  Json operator()(const Confirm& a) const {
    return {{"confirm", {{"at", json_of(a.at)}, {"radius_mm", a.radius_mm}, {"hold", a.hold}}}};
  }
  Json operator()(const SetScheme& a) const {
    return {{"scheme", name_of(scheme_names, a.scheme)}, {"events", a.paper_events}};
  }
  Json operator()(const SetSpacing& a) const { return {{"spacing", a.strength}}; }
  Json operator()(const PlaceLandmark& a) const {
    return {{"landmark", {{"name", a.name}, {"at", a.at ? json_of(*a.at) : Json()}}}};
  }
  Json operator()(const SetLandmarkFit& a) const { return {{"landmark_fit", name_of(fit_names, a.fit)}}; }
  Json operator()(const MirrorTemplate&) const { return {{"mirror", "sagittal"}}; }
  Json operator()(const SetFrame& a) const {
    Json line{{"frame", a.frame}};
    if (!a.step) line["look"] = true;
    return line;
  }
  Json operator()(const StartFrameFrom& a) const { return {{"start_frame_from", a.frame}}; }
  Json operator()(const Note& a) const { return {{"note", a.text}}; }
  Json operator()(const Undo&) const { return {{"undo", true}}; }
  Json operator()(const Redo&) const { return {{"redo", true}}; }
};

/// Runs a reader and turns whatever it throws into an Error.
template <class Read>
auto caught(const Read& read) -> Result<decltype(read())> {
  try {
    return read();
  } catch (const Unreadable& error) {
    return fail("", error.what);
  } catch (const nlohmann::json::out_of_range&) {
    return fail("", "lacks a key that its kind of line needs");
  } catch (const nlohmann::json::exception&) {
    return fail("", "holds a value of the wrong kind");
  }
}

}  // namespace

bool is_action_key(std::string_view key) {
  return std::any_of(std::begin(spellings), std::end(spellings),
                     [&](const Spelling& known) { return known.key == key; });
}

Json to_json(const Action& action) {
  return std::visit(Writer{}, action);
}

Result<Action> action_from_json(const Json& line) {
  if (!line.is_object()) return fail("", "is not a JSON object");
  for (const Spelling& spelling : spellings) {
    const auto value = line.find(spelling.key);
    if (value != line.end()) return caught([&] { return spelling.read(*value, line); });
  }
  return fail("", "is of no known kind; it may come from a newer version of Homolog");
}

std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

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

Json to_json(const Similarity& s) {
  return {{"rotation", Json::array({s.rotation.w(), s.rotation.x(), s.rotation.y(), s.rotation.z()})},
          {"scale", s.scale},
          {"translation", json_of(s.translation)}};
}

Result<Similarity> similarity_from_json(const Json& value) {
  return caught([&] { return similarity(value); });
}

}  // namespace homolog
