#include "core/mesh/landmark_io.h"

#include <cmath>
#include <set>

#include "core/base/files.h"
#include "core/base/json.h"
#include "core/base/text.h"

namespace homolog {
namespace {

using Json = nlohmann::ordered_json;

const Json* member(const Json& object, const char* key) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  return found == object.end() ? nullptr : &*found;
}

std::string text_of(const Json& object, const char* key) {
  const Json* value = member(object, key);
  return value && value->is_string() ? value->get<std::string>() : "";
}

Result<Landmark> landmark_of(std::string name, const Json* coordinates) {
  if (name.empty()) return fail("", "has a point without a name; name every point");
  if (name.size() > longest_name)
    return fail("", "has a point with a name of " + std::to_string(name.size()) + " bytes; give it a shorter one");
  Landmark landmark{std::move(name), {}};
  bool three_numbers = coordinates && coordinates->is_array() && coordinates->size() == 3;
  for (std::size_t axis = 0; three_numbers && axis < 3; ++axis) {
    const Json& coordinate = (*coordinates)[axis];
    if (coordinate.is_number()) landmark.position[static_cast<Eigen::Index>(axis)] = coordinate.get<double>();
    three_numbers = coordinate.is_number() && std::isfinite(landmark.position[static_cast<Eigen::Index>(axis)]);
  }
  if (!three_numbers)
    return fail("", "the point \"" + excerpt(landmark.name) + "\" does not have three coordinates; export it again");
  return landmark;
}

Result<void> add_slicer_markup(const Json& markup, std::vector<Landmark>& landmarks) {
  const std::string space = text_of(markup, "coordinateSystem");
  if (space != "LPS" && space != "RAS" && !space.empty())
    return fail("", "gives its points in \"" + excerpt(space) + "\"; save it in LPS or RAS");
  if (const Json* units = member(markup, "coordinateUnits");
      units && *units != "mm" && *units != Json({"mm", "mm", "mm"}))
    return fail("", "gives its points in other units than mm; save it in mm");
  const Json* points = member(markup, "controlPoints");
  if (!points || !points->is_array())
    return fail("", "has a markup without control points; save it in 3D Slicer again");
  for (const Json& point : *points) {
    const std::string status = text_of(point, "positionStatus");
    if (!status.empty() && status != "defined") continue;
    const std::string label = text_of(point, "label");
    auto landmark = landmark_of(label.empty() ? text_of(point, "id") : label, member(point, "position"));
    if (!landmark) return fail(landmark.error());
    if (space == "RAS") landmark->position.head<2>() *= -1;
    landmarks.push_back(std::move(*landmark));
  }
  return {};
}

Result<std::vector<Landmark>> landmarks_of(const Json& json) {
  std::vector<Landmark> landmarks;
  if (json.is_array()) {
    for (const Json& point : json) {
      auto landmark = landmark_of(text_of(point, "id"), member(point, "coordinates"));
      if (!landmark) return fail(landmark.error());
      landmarks.push_back(std::move(*landmark));
    }
  } else if (const Json* markups = member(json, "markups"); markups && markups->is_array()) {
    for (const Json& markup : *markups)
      if (auto added = add_slicer_markup(markup, landmarks); !added) return fail(added.error());
  } else {
    return fail("", "holds neither markups of 3D Slicer nor landmarks of scalismo; export the points as one of these");
  }
  std::set<std::string> names;
  for (const Landmark& landmark : landmarks)
    if (!names.insert(landmark.name).second)
      return fail("", "has two points named \"" + excerpt(landmark.name) + "\"; give every point a name of its own");
  return landmarks;
}

Json slicer_json(const std::vector<Landmark>& landmarks) {
  Json points = Json::array();
  for (const Landmark& landmark : landmarks)
    points.push_back({{"id", std::to_string(points.size() + 1)},
                      {"label", landmark.name},
                      {"position", std::vector(landmark.position.begin(), landmark.position.end())},
                      {"positionStatus", "defined"}});
  const Json markup = {{"type", "Fiducial"},
                       {"coordinateSystem", "LPS"},
                       {"coordinateUnits", "mm"},
                       {"controlPoints", std::move(points)}};
  return {{"@schema",
           "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/"
           "markups-schema-v1.0.3.json#"},
          {"markups", Json::array({markup})}};
}

Json scalismo_json(const std::vector<Landmark>& landmarks) {
  Json points = Json::array();
  for (const Landmark& landmark : landmarks)
    points.push_back(
        {{"id", landmark.name}, {"coordinates", std::vector(landmark.position.begin(), landmark.position.end())}});
  return points;
}

}  // namespace

Result<std::vector<Landmark>> read_landmarks(const std::filesystem::path& path) {
  const auto text = read_whole_file(path, std::uintmax_t{1} << 26);
  if (!text) return fail(text.error());
  const auto json = read_json<Json>(*text);
  if (!json) return fail(path.string(), json.error().what + "; export it again");
  auto landmarks = landmarks_of(*json);
  if (!landmarks) return fail(path.string(), landmarks.error().what);
  return landmarks;
}

Result<void> write_landmarks(const std::vector<Landmark>& landmarks, const std::filesystem::path& path) {
  if (path.extension() != ".json")
    return fail(path.string(), "is not a landmark file; use .mrk.json (3D Slicer) or .json (scalismo)");
  const bool slicer = path.stem().extension() == ".mrk";
  const Json json = slicer ? slicer_json(landmarks) : scalismo_json(landmarks);
  return write_whole_file(path, json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
}

}  // namespace homolog
