#include "core/session/checkpoint.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/base/json.h"
#include "core/base/limits.h"
#include "core/base/same_values.h"
#include "core/case/action_json.h"
#include "core/case/packed.h"
#include "core/case/placing.h"
#include "core/mesh/mirror.h"
#include "core/session/case_lines.h"

namespace homolog {

namespace {

using Json = nlohmann::ordered_json;

// What makes a line no checkpoint of this case is thrown, as the JSON library throws, and caught in read_checkpoint.
struct Unusable {};

Json packed_array(const auto& array) {
  return packed(std::span(array.data(), static_cast<std::size_t>(array.size())));
}

template <class Array>
std::shared_ptr<const Array> unpacked_array(const Json& value, Eigen::Index rows, Eigen::Index columns) {
  const auto numbers = unpacked<double>(value.get_ref<const std::string&>(), static_cast<std::size_t>(rows * columns));
  if (!numbers) throw Unusable{};
  return std::make_shared<const Array>(Eigen::Map<const Array>(numbers->data(), rows, columns));
}

bool same_landmarks(const std::vector<Landmark>& a, const std::vector<Landmark>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Landmark& x, const Landmark& y) { return x.name == y.name && x.position == y.position; });
}

bool same_template(const Template& a, const Template& b) {
  return &a == &b || (a.source == b.source && a.topology->triangles() == b.topology->triangles() &&
                      a.points == b.points && a.stiffness == b.stiffness && a.stiffness_base == b.stiffness_base &&
                      a.regions == b.regions && same_landmarks(a.landmarks, b.landmarks));
}

// Shape and Document are taken apart, so that a new member does not compile until it is kept and compared here.

bool same_shape(const Shape& a, const Shape& b) {
  const auto& [placement, before_landmarks, landmarks, placed, reference, points, confirmed, decided, unaided, strokes,
               pulled, pulls, unsnapped, carried, doubt, doubt_mm, outlier] = a;
  return placement == b.placement && before_landmarks == b.before_landmarks && landmarks == b.landmarks &&
         strokes == b.strokes && same_values(placed, b.placed) && same_values(reference, b.reference) &&
         same_values(points, b.points) && same_values(confirmed, b.confirmed) && same_values(decided, b.decided) &&
         same_values(unaided, b.unaided) && same_values(carried, b.carried) && doubt == b.doubt &&
         same_values(doubt_mm, b.doubt_mm) && same_values(outlier, b.outlier) && same_values(pulled, b.pulled) &&
         pulls == b.pulls && same_values(unsnapped, b.unsnapped) &&
         (reference == placed) == (b.reference == b.placed) && (points == reference) == (b.points == b.reference);
}

// A case changes its template in two ways: it turns it into that of the other side, and it names landmarks.

Json template_changes(const Template& start, const Template& now) {
  Json changes{{"mirrored", start.topology->triangles() != now.topology->triangles()}};
  Json landmarks = Json::array();
  for (const Landmark& landmark : now.landmarks)
    landmarks.push_back({{"name", landmark.name}, {"at", packed_array(landmark.position)}});
  changes["landmarks"] = std::move(landmarks);
  return changes;
}

std::shared_ptr<const Template> changed_template(std::shared_ptr<const Template> start, const Json& changes) {
  auto now = std::move(start);
  if (changes.at("mirrored").get<bool>()) {
    auto other_side = make_template(mirrored(to_mesh_file(*now)), now->source);
    if (!other_side) throw Unusable{};
    now = *other_side;
  }
  std::vector<Landmark> landmarks;
  for (const Json& landmark : changes.at("landmarks"))
    landmarks.push_back({landmark.at("name").get<std::string>(), *unpacked_array<Vec3>(landmark.at("at"), 3, 1)});
  return same_landmarks(landmarks, now->landmarks) ? now : with_landmarks(*now, std::move(landmarks));
}

Json json_of(const Shape& shape) {
  Json json{{"placement", to_json(shape.placement)},
            {"before_landmarks", to_json(shape.before_landmarks)},
            {"strokes", shape.strokes}};
  Json landmarks = Json::object();
  for (const auto& [name, at] : shape.landmarks) landmarks[name] = packed_array(at);
  json["landmarks"] = std::move(landmarks);
  // What is left out follows from the template and the placement.
  if (shape.reference != shape.placed) json["reference"] = packed_array(*shape.reference);
  if (shape.points != shape.reference) json["points"] = packed_array(*shape.points);
  if (shape.confirmed) json["confirmed"] = packed_array(*shape.confirmed);
  if (shape.decided) json["decided"] = packed_array(*shape.decided);
  if (shape.unaided) json["unaided"] = packed_array(*shape.unaided);
  if (shape.carried)
    json["carried"] = same_values(shape.carried, shape.points) ? "points" : packed_array(*shape.carried);
  if (!shape.doubt.empty()) json["doubt"] = shape.doubt;
  if (shape.doubt_mm) json["doubt_mm"] = packed_array(*shape.doubt_mm);
  if (shape.outlier) json["outlier"] = packed_array(*shape.outlier);
  if (shape.pulled) json["pulled"] = packed_array(*shape.pulled);
  if (shape.pulls > 0) json["pulls"] = shape.pulls;
  if (shape.unsnapped) json["unsnapped"] = packed_array(*shape.unsnapped);
  return json;
}

Shape shape_of(const Json& json, const Template& the_template) {
  const Eigen::Index n = the_template.points.rows();
  const auto points = [&](const char* key, std::shared_ptr<const Points> otherwise) {
    return json.contains(key) ? unpacked_array<Points>(json.at(key), n, 3) : std::move(otherwise);
  };
  const auto scalars = [&](const char* key) {
    return json.contains(key) ? unpacked_array<VertexScalars>(json.at(key), n, 1) : nullptr;
  };
  const auto placement = similarity_from_json(json.at("placement"));
  const auto before_landmarks = similarity_from_json(json.at("before_landmarks"));
  if (!placement || !before_landmarks) throw Unusable{};
  Shape shape;
  shape.placement = *placement;
  shape.before_landmarks = *before_landmarks;
  for (const auto& [name, at] : json.at("landmarks").items()) shape.landmarks[name] = *unpacked_array<Vec3>(at, 3, 1);
  shape.placed = std::make_shared<const Points>(shape.placement.apply(the_template.points));
  shape.reference = points("reference", shape.placed);
  shape.points = points("points", shape.reference);
  shape.confirmed = scalars("confirmed");
  shape.decided = scalars("decided");
  shape.unaided = points("unaided", nullptr);
  shape.carried = json.value("carried", "") == "points" ? shape.points : points("carried", nullptr);
  shape.doubt = json.value("doubt", "");
  shape.doubt_mm = scalars("doubt_mm");
  shape.outlier = scalars("outlier");
  shape.pulled = scalars("pulled");
  shape.pulls = json.value("pulls", 0);
  shape.unsnapped = points("unsnapped", nullptr);
  shape.strokes = json.at("strokes").get<int>();
  return shape;
}

Json json_of(const Document& start, const Document& document) {
  Json regions = Json::array();
  for (const Region& region : document.regions->list)
    regions.push_back({{"name", region.name}, {"factor", region.factor}, {"colour", hex_of(region.colour)}});
  Json shapes = Json::array();
  for (const auto& [frame, shape] : document.shapes) {
    shapes.push_back(json_of(shape));
    shapes.back()["frame"] = frame;
  }
  return {{"frame", document.frame},
          {"template", template_changes(*start.the_template, *document.the_template)},
          {"stiffness", packed_array(*document.stiffness)},
          {"stiffness_base", document.stiffness_base},
          {"regions", std::move(regions)},
          {"of_vertex", packed_array(document.regions->of_vertex)},
          {"regions_of", document.regions->of_vertex.size()},
          {"scheme", static_cast<int>(document.scheme)},
          {"events", document.paper_events},
          {"spacing", document.even_spacing},
          {"landmark_fit", static_cast<int>(document.landmark_pull)},
          {"shapes", std::move(shapes)}};
}

Document document_of(const Json& json, const Document& start) {
  Document document = start;
  document.frame = json.at("frame").get<int>();
  document.the_template = changed_template(start.the_template, json.at("template"));
  document.stiffness = unpacked_array<VertexScalars>(json.at("stiffness"), start.stiffness->size(), 1);
  document.stiffness_base = json.at("stiffness_base").get<double>();
  auto regions = std::make_shared<Regions>();
  for (const Json& region : json.at("regions")) {
    const auto colour = colour_from_hex(region.at("colour").get<std::string>());
    if (!colour) throw Unusable{};
    regions->list.push_back({region.at("name").get<std::string>(), region.at("factor").get<double>(), *colour});
  }
  auto of_vertex = unpacked<std::uint8_t>(json.at("of_vertex").get_ref<const std::string&>(),
                                          json.at("regions_of").get<std::size_t>());
  if (!of_vertex) throw Unusable{};
  regions->of_vertex = std::move(*of_vertex);
  document.regions = std::move(regions);
  document.scheme = static_cast<Scheme>(json.at("scheme").get<int>());
  document.paper_events = json.at("events").get<int>();
  document.even_spacing = json.at("spacing").get<double>();
  document.landmark_pull = static_cast<LandmarkPull>(json.at("landmark_fit").get<int>());
  document.shapes.clear();
  for (const Json& shape : json.at("shapes"))
    document.shapes.emplace(shape.at("frame").get<int>(), shape_of(shape, *document.the_template));
  return document;
}

bool is_positive(double value) {
  return value > 0 && std::isfinite(value);
}

bool is_sound(const Regions& regions, Eigen::Index vertices) {
  const std::size_t numbers = regions.of_vertex.size(), most = regions.list.size();
  return (numbers == 0 || numbers == static_cast<std::size_t>(vertices)) && most <= 255 &&
         std::all_of(regions.of_vertex.begin(), regions.of_vertex.end(), [&](auto number) { return number <= most; }) &&
         std::all_of(regions.list.begin(), regions.list.end(),
                     [](const Region& region) { return is_positive(region.factor); });
}

bool is_sound(const Shape& shape) {
  const auto finite = [](const auto& values) { return !values || all_in_reach(*values); };
  return check_placement(shape.placement) && check_placement(shape.before_landmarks) && finite(shape.points) &&
         finite(shape.reference) && finite(shape.confirmed) && finite(shape.decided) && finite(shape.unaided) &&
         finite(shape.carried) && finite(shape.doubt_mm) && finite(shape.outlier) && finite(shape.pulled) &&
         finite(shape.unsnapped) && shape.strokes >= 0 && shape.pulls >= 0 &&
         std::all_of(shape.landmarks.begin(), shape.landmarks.end(),
                     [](const auto& landmark) { return all_in_reach(landmark.second); });
}

/// Whether a document is one that actions can make: a line that was damaged may be read and hold anything.
bool is_sound(const Document& document) {
  const int frames = document.volume ? document.volume->frames : 1;
  const auto frame_exists = [&](int frame) { return frame >= 0 && frame < frames; };
  return frame_exists(document.frame) && document.has_shape() && is_positive(document.stiffness_base) &&
         document.stiffness->allFinite() && (document.stiffness->array() > 0).all() &&
         is_sound(*document.regions, document.stiffness->size()) && document.scheme >= Scheme::anchored &&
         document.scheme <= Scheme::raw && document.paper_events >= 1 && document.paper_events <= 1000 &&
         document.even_spacing >= 0 && document.even_spacing <= 1 && document.landmark_pull >= LandmarkPull::off &&
         document.landmark_pull <= LandmarkPull::warp &&
         std::all_of(document.shapes.begin(), document.shapes.end(),
                     [&](const auto& one) { return frame_exists(one.first) && is_sound(one.second); });
}

/// A checksum of all that a replay starts from.
std::uint32_t start_check(const Document& start) {
  const auto bytes_of = [](const auto& array) {
    return std::string_view(reinterpret_cast<const char*>(array.data()),
                            static_cast<std::size_t>(array.size()) * sizeof(*array.data()));
  };
  const int frames = start.volume ? start.volume->frames : 1;
  std::uint32_t check = CaseLines::checked(0, bytes_of(start.the_template->points));
  check = CaseLines::checked(check, bytes_of(start.the_template->topology->triangles()));
  // The first line decides what json_of takes from the start.
  return CaseLines::checked(check, json_of(start, start).dump() + std::to_string(frames) + '/' +
                                       std::to_string(static_cast<int>(start.landmark_rule)) +
                                       (start.holds_landmarks ? "held" : ""));
}

}  // namespace

bool same_document(const Document& a, const Document& b) {
  const auto& [volume_source, volume, the_template, shapes, frame, stiffness, regions, stiffness_base, scheme,
               paper_events, even_spacing, landmark_pull, landmark_rule, holds_landmarks] = a;
  return volume_source == b.volume_source && volume == b.volume && frame == b.frame &&
         (!the_template) == (!b.the_template) && (!the_template || same_template(*the_template, *b.the_template)) &&
         same_values(stiffness, b.stiffness) && same_values(regions, b.regions) && stiffness_base == b.stiffness_base &&
         scheme == b.scheme && paper_events == b.paper_events && even_spacing == b.even_spacing &&
         landmark_pull == b.landmark_pull && landmark_rule == b.landmark_rule && holds_landmarks == b.holds_landmarks &&
         std::equal(shapes.begin(), shapes.end(), b.shapes.begin(), b.shapes.end(),
                    [](const auto& x, const auto& y) { return x.first == y.first && same_shape(x.second, y.second); });
}

std::optional<std::string> checkpoint_line(const Document& start, const Document& document, std::uint32_t lines_check) {
  if (!start.the_template || !start.has_shape() || !document.the_template) return std::nullopt;
  std::string line;
  try {
    const Json checkpoint{{"version", HOMOLOG_VERSION},
                          {"start", start_check(start)},
                          {"lines", lines_check},
                          {"document", json_of(start, document)}};
    line = Json{{"checkpoint", checkpoint}}.dump();
  } catch (const Json::exception&) {
    return std::nullopt;  // a name that is no UTF-8
  }
  const auto read = read_checkpoint(line, start, lines_check);
  if (!read || !same_document(*read, document)) return std::nullopt;
  return line;
}

std::optional<Document> read_checkpoint(const std::string& line, const Document& start, std::uint32_t lines_check) {
  if (!start.the_template || !start.has_shape()) return std::nullopt;
  const auto json = read_json<Json>(line);
  if (!json) return std::nullopt;
  try {
    const Json& checkpoint = json->at("checkpoint");
    if (checkpoint.at("version") != HOMOLOG_VERSION || checkpoint.at("start") != start_check(start) ||
        checkpoint.at("lines") != lines_check)
      return std::nullopt;
    Document document = document_of(checkpoint.at("document"), start);
    return is_sound(document) ? std::optional(std::move(document)) : std::nullopt;
  } catch (const Unusable&) {
    return std::nullopt;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

}  // namespace homolog
