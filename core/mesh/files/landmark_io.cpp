#include "core/mesh/files/landmark_io.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <set>

#include "core/base/encoding/json.h"
#include "core/base/files/files.h"
#include "core/base/numbers/limits.h"
#include "core/base/text/text.h"
#include "core/mesh/files/slicer_curves.h"

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
  if (!all_in_reach(landmark.position))
    return fail("", "the point \"" + excerpt(landmark.name) + "\" " + beyond_farthest + "; export it again in mm");
  return landmark;
}

/// The value in a line "# key = value" of a .fcsv; empty for another key.
std::string_view fcsv_value(std::string_view line, std::string_view key) {
  const auto bare = [](std::string_view text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '#')) text.remove_prefix(1);
    while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
    return text;
  };
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos || bare(line.substr(0, equals)) != key) return {};
  return bare(line.substr(equals + 1));
}

/// The columns of a .fcsv that a landmark is read from, of `all`.
struct FcsvColumns {
  std::size_t id = 0, x = 1, label = 11, all = 14;
  std::optional<std::size_t> turned = 4;  ///< the first of four that hold a unit quaternion
};

Result<FcsvColumns> fcsv_columns(std::string_view names) {
  const auto fields = csv_fields(names);
  const auto find = [&](std::string_view name) {
    return static_cast<std::size_t>(std::find(fields.begin(), fields.end(), name) - fields.begin());
  };
  FcsvColumns columns{find("id"), find("x"), find("label"), fields.size(), std::nullopt};
  if (find("ow") + 3 < fields.size()) columns.turned = find("ow");
  if (columns.x + 2 >= fields.size() || fields[columns.x + 1] != "y" || fields[columns.x + 2] != "z")
    return fail("", "has no columns x, y and z; save it in 3D Slicer again");
  return columns;
}

/// Whether a line has the fields that its columns say. 3D Slicer 5 adds two numbers that it names no columns for. A
/// decimal comma makes two fields of one, so that x, y and z would be other numbers than were meant.
bool fits_columns(const std::vector<std::string>& fields, const FcsvColumns& columns) {
  const std::size_t count = fields.size();
  const bool place_alone = count == columns.x + 3 && columns.id < count;
  if (count < columns.all && !place_alone && count <= columns.label) return false;
  if (count > columns.all &&
      !(count == columns.all + 2 && as_number<int>(fields[count - 1]) && as_number<int>(fields[count - 2])))
    return false;
  if (!columns.turned || *columns.turned + 3 >= count) return true;
  double squares = 0;
  for (std::size_t k = *columns.turned; k < *columns.turned + 4; ++k) {
    const double part = std::strtod(fields[k].c_str(), nullptr);
    squares += part * part;
  }
  return squares < 1e-6 || std::abs(squares - 1) < 0.1;
}

Result<std::vector<Landmark>> fcsv_landmarks(std::string_view text) {
  std::vector<Landmark> landmarks;
  FcsvColumns columns;
  bool ras = true, known = false;  // files without a line about it are older than LPS
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (line.starts_with('#')) {
      known = known || line.find("Markups fiducial file") != std::string_view::npos;
      if (const auto space = fcsv_value(line, "CoordinateSystem"); !space.empty()) {
        if (space != "LPS" && space != "1" && space != "RAS" && space != "0")
          return fail("", "gives its points in \"" + excerpt(space) + "\"; save it in LPS or RAS");
        ras = space == "RAS" || space == "0";
      }
      if (const auto names = fcsv_value(line, "columns"); !names.empty()) {
        const auto read = fcsv_columns(names);
        if (!read) return fail(read.error());
        columns = *read;
      }
      continue;
    }
    if (line.find_first_not_of(' ') == std::string_view::npos) continue;
    const auto fields = csv_fields(line);
    if (!fits_columns(fields, columns))
      return fail("", "has a line with other fields than its columns say (\"" + excerpt(line) +
                          "\"), as decimal commas give; save it with decimal points");
    const auto field = [&](std::size_t column) { return column < fields.size() ? fields[column] : std::string(); };
    Json coordinates = Json::array();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (const auto value = as_number<double>(field(columns.x + axis))) coordinates.push_back(*value);
    }
    const std::string label = field(columns.label);
    auto landmark = landmark_of(label.empty() ? field(columns.id) : label, &coordinates);
    if (!landmark) return fail(landmark.error());
    if (ras) landmark->position.head<2>() *= -1;
    landmarks.push_back(std::move(*landmark));
  }
  if (!known) return fail("", "is no fiducial file of 3D Slicer; export the points as .mrk.json");
  return landmarks;
}

Result<void> check_names(const std::vector<Landmark>& landmarks) {
  std::set<std::string> names;
  for (const Landmark& landmark : landmarks)
    if (!names.insert(landmark.name).second)
      return fail("", "has two points named \"" + excerpt(landmark.name) + "\"; give every point a name of its own");
  return {};
}

/// `unnamed`: what a point is called that has no name; empty: it needs one.
Result<void> add_slicer_markup(const Json& markup, std::vector<Landmark>& landmarks, const std::string& unnamed = {}) {
  const Json* named = member(markup, "coordinateSystem");
  if (named != nullptr && !named->is_string())
    return fail("", "gives its coordinateSystem as " + excerpt(named->dump()) +
                        ", which is no name of a space; write \"LPS\" or \"RAS\"");
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
    const std::string label = text_of(point, "label"), id = text_of(point, "id");
    auto landmark = landmark_of(!label.empty() ? label : !id.empty() ? id : unnamed, member(point, "position"));
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
  return landmarks;
}

Result<std::vector<SlicerCurve>> curves_of(const Json& json) {
  const Json* markups = member(json, "markups");
  if (markups == nullptr || !markups->is_array())
    return fail("", "holds no markups of 3D Slicer; save the curves there as .mrk.json");
  std::vector<SlicerCurve> curves;
  for (const Json& markup : *markups) {
    const std::string type = text_of(markup, "type");
    if (type != "Curve" && type != "ClosedCurve") continue;
    std::vector<Landmark> points;
    if (auto added = add_slicer_markup(markup, points, "a point of a curve"); !added) return fail(added.error());
    SlicerCurve& curve = curves.emplace_back();
    curve.closed = type == "ClosedCurve";
    curve.type = text_of(markup, "curveType");
    for (const Landmark& point : points) curve.points.push_back(point.position);
  }
  if (curves.empty()) return fail("", "holds no curves, points at most; draw curves in 3D Slicer and save these");
  return curves;
}

std::string fcsv_text(const std::vector<Landmark>& landmarks) {
  std::string text =
      "# Markups fiducial file version = 4.11\n# CoordinateSystem = LPS\n"
      "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n";
  std::size_t id = 0;
  for (const Landmark& landmark : landmarks) {
    text += std::to_string(++id);
    for (const double x : landmark.position) {
      char digits[32];
      text += ',' + std::string(digits, std::to_chars(digits, digits + sizeof digits, x).ptr);
    }
    std::string name;
    for (const char c : landmark.name) name += c == '"' ? "\"\"" : std::string(1, c == '\n' || c == '\r' ? ' ' : c);
    const bool quotes = name.find_first_of(",\"") != std::string::npos;
    text += ",0,0,0,1,1,1,0," + (quotes ? '"' + name + '"' : name) + ",,\n";
  }
  return text;
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

Result<std::vector<Landmark>> json_landmarks(std::string_view text) {
  const auto json = read_json<Json>(text);
  if (!json) return fail("", json.error().what + "; export it again");
  return landmarks_of(*json);
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
  const auto text = read_whole_file(path, std::uintmax_t{1} << 24);
  if (!text) return fail(text.error());
  auto landmarks = path.extension() == ".fcsv" ? fcsv_landmarks(*text) : json_landmarks(*text);
  if (!landmarks) return fail(path.string(), landmarks.error().what);
  if (auto checked = check_names(*landmarks); !checked) return fail(path.string(), checked.error().what);
  return landmarks;
}

Result<std::vector<SlicerCurve>> read_slicer_curves(const std::filesystem::path& path) {
  const auto text = read_whole_file(path, std::uintmax_t{1} << 24);
  if (!text) return fail(text.error());
  const auto json = read_json<Json>(*text);
  if (!json) return fail(path.string(), json.error().what + "; export it again");
  auto curves = curves_of(*json);
  if (!curves) return fail(path.string(), curves.error().what);
  return curves;
}

Result<void> write_landmarks(const std::vector<Landmark>& landmarks, const std::filesystem::path& path) {
  if (path.extension() == ".fcsv") return write_whole_file(path, fcsv_text(landmarks));
  if (path.extension() != ".json")
    return fail(path.string(), "is not a landmark file; use .mrk.json or .fcsv (3D Slicer) or .json (scalismo)");
  const bool slicer = path.stem().extension() == ".mrk";
  const Json json = slicer ? slicer_json(landmarks) : scalismo_json(landmarks);
  return write_whole_file(path, json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
}

}  // namespace homolog
