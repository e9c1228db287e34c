#include "core/structures/template_set.h"

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <utility>

#include "core/base/encoding/json.h"
#include "core/base/files/file_record.h"
#include "core/base/files/files.h"
#include "core/base/files/paths.h"
#include "core/base/numbers/limits.h"
#include "core/base/pictures/colour.h"
#include "core/base/text/text.h"
#include "core/catalogue/catalogue.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/structures/naming/level_names.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

constexpr int version = 1;
constexpr std::array side_names{"", "left", "right"};

std::optional<Vec3> three_numbers(const Json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_array() || found->size() != 3) return std::nullopt;
  Vec3 numbers;
  for (int k = 0; k < 3; ++k) {
    const Json& one = (*found)[k];
    if (!one.is_number()) return std::nullopt;
    numbers[k] = one.get<double>();
  }
  return numbers;
}

/// None where it is no pose.
std::optional<RelativePose> parsed_pose(const Json& json) {
  const auto subjects = json.find("subjects");
  const auto offset = three_numbers(json, "offset_mm"), turn = three_numbers(json, "turn_deg");
  if (subjects == json.end() || !subjects->is_number_unsigned() || !offset || !turn || !all_in_reach(*offset) ||
      !turn->allFinite())
    return std::nullopt;
  const auto number = [&](const char* key, double otherwise) {
    const auto found = json.find(key);
    return found != json.end() && found->is_number() ? found->get<double>() : otherwise;
  };
  return RelativePose{subjects->get<std::size_t>(),
                      *offset,
                      *turn,
                      number("scale", 1),
                      number("offset_sd_mm", 0),
                      number("turn_sd_deg", 0),
                      number("scale_sd", 0)};
}

Result<TemplateOfSet> parsed_structure(Json json, std::size_t number, const fs::path& folder) {
  const std::string where = "structure " + std::to_string(number);
  if (!json.is_object()) return fail("", where + " is no object; correct it in an editor");
  const auto text = [&](const char* key) {
    const auto found = json.find(key);
    std::string value = found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
    if (found != json.end() && found->is_string()) json.erase(found);
    return value;
  };
  TemplateOfSet one;
  one.name = text("name");
  const std::string file = text("template"), side = text("side"), colour = text("colour");
  if (one.name.empty() || file.empty())
    return fail("", where + " has no \"name\" or no \"template\"; give both, or make the set again");
  one.file = names_file(file) ? (folder / file).lexically_normal() : fs::path(file);
  one.side = side == "left" ? Side::left : side == "right" ? Side::right : Side::none;
  if (!side.empty() && one.side == Side::none)
    return fail("",
                where + " has the side \"" + excerpt(side) + "\", and there are \"left\" and \"right\"; correct it");
  one.partner = text("partner");
  one.colour = colour_from_hex(colour);
  if (!colour.empty() && !one.colour)
    return fail("", where + " has the colour \"" + excerpt(colour) + "\", which is none like \"#60a5d6\"; correct it");
  if (const auto value = json.find("value"); value != json.end()) {
    if (!value->is_number_integer() || *value < 0 || *value > std::numeric_limits<int>::max())
      return fail("", where + " has the value " + excerpt(value->dump()) +
                          ", which no label can have; give a whole number from 0");
    one.value = value->get<int>();
    json.erase(value);
  }
  if (const auto layer = json.find("layer"); layer != json.end() && layer->is_number_unsigned()) {
    one.layer = layer->get<std::size_t>();
    json.erase(layer);
  }
  if (const auto near = json.find("neighbours"); near != json.end() && near->is_array()) {
    for (const Json& name : *near)
      if (name.is_string()) one.neighbours.push_back(name.get<std::string>());
    json.erase(near);
  }
  if (const auto pose = json.find("pose"); pose != json.end() && pose->is_object()) {
    one.pose = parsed_pose(*pose);
    constexpr std::array numbers{"subjects", "offset_mm", "turn_deg"};
    if (!one.pose && std::ranges::any_of(numbers, [&](const char* key) { return pose->contains(key); }))
      return fail("", where + " (" + excerpt(one.name) +
                          ") has a \"pose\" that lacks a number or holds what is none in reach (subjects, offset_mm, "
                          "turn_deg); correct it, or make the set again");
    if (one.pose) json.erase(pose);
  }
  one.other = std::move(json);
  return one;
}

Result<std::vector<SharedVertices>> parsed_shared(const Json& json) {
  std::vector<SharedVertices> shared;
  const auto unreadable = [] {
    return fail("",
                "says of shared vertices what cannot be read; take \"shared\" out and declare them anew with set "
                "share");
  };
  if (!json.is_array()) return unreadable();
  for (const Json& entry : json) {
    const Json names = entry.is_object() && entry.contains("structures") ? entry["structures"] : Json();
    const Json vertices = entry.is_object() && entry.contains("vertices") ? entry["vertices"] : Json();
    if (!names.is_array() || names.size() != 2 || !names[0].is_string() || !names[1].is_string() ||
        !vertices.is_string())
      return unreadable();
    auto pairs = pairs_of_text(vertices.get_ref<const std::string&>());
    if (!pairs) return unreadable();
    shared.push_back({names[0].get<std::string>(), names[1].get<std::string>(), std::move(*pairs)});
  }
  return shared;
}

Result<TemplateSet> parsed_set(Json json, const fs::path& folder) {
  const auto stamp = json.is_object() ? json.find("homolog_set") : json.end();
  if (!json.is_object() || stamp == json.end() || !stamp->is_number_integer())
    return fail("", "is no template set; a set starts with \"homolog_set\"");
  if (*stamp < 1)
    return fail(
        "", "says that it is of set version " + excerpt(stamp->dump()) + ", which there is none of; correct it to 1");
  if (*stamp > version)
    return fail(
        "", "was written by a newer version of this program (set version " + excerpt(stamp->dump()) + "); update it");
  json.erase(stamp);
  const Json structures = json.contains("structures") ? json["structures"] : Json::array();
  json.erase("structures");
  if (!structures.is_array() || structures.empty())
    return fail("", "has no \"structures\"; make it with homolog set make");
  TemplateSet set;
  if (const auto known = json.find("shared"); known != json.end()) {
    auto shared = parsed_shared(*known);
    if (!shared) return fail(shared.error());
    set.shared = std::move(*shared);
    json.erase("shared");
  }
  std::set<std::string> names;
  std::map<std::pair<std::size_t, int>, std::string> of_value;
  for (const Json& entry : structures) {
    auto one = parsed_structure(entry, set.structures.size() + 1, folder);
    if (!one) return fail(one.error());
    if (!names.insert(lower_case(one->name)).second)
      return fail("", "has two structures named \"" + excerpt(one->name) + "\"; rename one of them");
    const auto [same, is_new] = of_value.emplace(std::pair(one->layer, one->value), one->name);
    if (!is_new && one->value != 0)
      return fail("", "gives " + excerpt(same->second) + " and " + excerpt(one->name) + " the value " +
                          std::to_string(one->value) + "; give one of them another");
    set.structures.push_back(std::move(*one));
  }
  json.erase(std::string(record_key));  // the record is of the file as it was made
  set.other = std::move(json);
  return set;
}

/// How near two surfaces come: from the vertices of one to the faces of the other.
double gap_mm(const SurfaceSearch& search, const Points& points, const Box& within) {
  double nearest = std::numeric_limits<double>::infinity();
  for (Eigen::Index v = 0; v < points.rows(); ++v) {
    const Vec3 p = points.row(v);
    if (within.contains(p)) nearest = std::min(nearest, search.nearest(p).distance_mm);
  }
  return nearest;
}

}  // namespace

const TemplateOfSet* TemplateSet::find(const std::string& name) const {
  const std::string wanted = lower_case(name);
  const auto found =
      std::ranges::find_if(structures, [&](const TemplateOfSet& one) { return lower_case(one.name) == wanted; });
  return found == structures.end() ? nullptr : &*found;
}

bool is_template_set(const fs::path& file) {
  return lower_case(file.string()).ends_with(".set.json");
}

std::string file_name_of_structure(const std::string& name) {
  std::string file = name;
  for (char& c : file)
    if (c == '/' || c == '\\' || c == ':') c = '_';
  return file;
}

nlohmann::ordered_json json_of_pose(const RelativePose& pose) {
  const auto three = [](const Vec3& v) { return Json{v.x(), v.y(), v.z()}; };
  Json json{{"subjects", pose.subjects},
            {"offset_mm", three(pose.offset_mm)},
            {"turn_deg", three(pose.turn_deg)},
            {"scale", pose.scale}};
  if (pose.subjects > 1)
    json.update({{"offset_sd_mm", pose.offset_sd_mm}, {"turn_sd_deg", pose.turn_sd_deg}, {"scale_sd", pose.scale_sd}});
  return json;
}

Result<TemplateSet> read_template_set(const fs::path& path) {
  const auto bytes = read_whole_file(path);
  if (!bytes) return fail(bytes.error());
  auto json = read_json<Json>(*bytes);
  if (!json) return fail(path.string(), json.error().what + "; take its last good copy");
  auto set = parsed_set(std::move(*json), absolute_path(path).parent_path());
  if (!set) return fail(path.string(), set.error().what);
  return set;
}

Result<void> write_template_set(const TemplateSet& set, const fs::path& path, const std::string& record) {
  const fs::path folder = absolute_path(path).parent_path();
  Json json{{"homolog_set", version}};
  json.update(set.other);
  json["structures"] = Json::array();
  for (const TemplateOfSet& one : set.structures) {
    Json entry{{"name", one.name}, {"value", one.value}};
    if (one.layer != 0) entry["layer"] = one.layer;
    if (one.colour) entry["colour"] = hex_of(*one.colour);
    entry["template"] = relative_source(folder, one.file.string());
    if (one.side != Side::none) entry["side"] = side_names[static_cast<std::size_t>(one.side)];
    if (!one.partner.empty()) entry["partner"] = one.partner;
    entry["neighbours"] = one.neighbours;
    if (one.pose) entry["pose"] = json_of_pose(*one.pose);
    entry.update(one.other);
    json["structures"].push_back(std::move(entry));
  }
  for (const SharedVertices& one : set.shared)
    json["shared"].push_back({{"structures", {one.a, one.b}}, {"vertices", text_of_pairs(one.vertices)}});
  const auto text = with_record(path, json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n', record);
  return text ? write_whole_file(path, *text) : fail(text.error());
}

void find_partners(TemplateSet& set) {
  for (TemplateOfSet& one : set.structures) {
    if (one.side == Side::none) one.side = side_in(one.name);
    const std::string other = name_of_other_side(one.name);
    const TemplateOfSet* partner = other.empty() ? nullptr : set.find(other);
    if (partner != nullptr && one.partner.empty()) one.partner = partner->name;
  }
}

std::string names_in_set(const TemplateSet& set) {
  constexpr std::size_t most = 6;
  std::string text;
  for (std::size_t k = 0; k < std::min(most, set.structures.size()); ++k)
    text += (k > 0 ? ", " : "") + set.structures[k].name;
  return set.structures.size() > most ? text + " and " + std::to_string(set.structures.size() - most) + " more" : text;
}

Result<void> rename_structure(TemplateSet& set, const std::string& name, const std::string& new_name) {
  const TemplateOfSet* found = set.find(name);
  if (found == nullptr) return fail("", "has no structure \"" + excerpt(name) + "\"; it has " + names_in_set(set));
  if (trimmed(new_name).empty() || !is_utf8(new_name) || printable(new_name) != new_name)
    return fail("", "cannot call a structure \"" + excerpt(new_name) + "\"; give a name in letters and digits");
  TemplateOfSet& one = set.structures[found - set.structures.data()];
  const auto of_file = [](const std::string& text) { return lower_case(file_name_of_structure(text)); };
  for (const TemplateOfSet& other : set.structures)
    if (&other != &one && of_file(other.name) == of_file(new_name))
      return fail("", "has a structure named \"" + excerpt(other.name) + "\" already; choose another name");
  const std::string old_name = std::exchange(one.name, new_name);
  const auto follow = [&](std::string& known) {
    if (lower_case(known) == lower_case(old_name)) known = new_name;
  };
  for (TemplateOfSet& other : set.structures) {
    follow(other.partner);
    for (std::string& neighbour : other.neighbours) follow(neighbour);
  }
  for (SharedVertices& shared : set.shared) {
    follow(shared.a);
    follow(shared.b);
  }
  if (side_in(new_name) == Side::none) return {};
  one.side = side_in(new_name);
  for (TemplateOfSet& other : set.structures)
    if (lower_case(other.partner) == lower_case(new_name)) other.partner.clear();
  one.partner.clear();
  find_partners(set);
  return {};
}

void find_neighbours(TemplateSet& set, const std::vector<Mesh>& meshes, double near_mm) {
  const std::size_t count = set.structures.size();
  std::vector<std::vector<std::pair<double, std::size_t>>> near(count);
  for (std::size_t a = 0; a < count; ++a) {
    const SurfaceSearch search(meshes[a]);
    Box reach = bounds_of(meshes[a].points);
    reach.min().array() -= near_mm;
    reach.max().array() += near_mm;
    for (std::size_t b = 0; b < count; ++b) {
      if (a == b || !reach.intersects(bounds_of(meshes[b].points))) continue;
      if (const double gap = gap_mm(search, meshes[b].points, reach); gap <= near_mm) {
        near[a].emplace_back(gap, b);
        near[b].emplace_back(gap, a);
      }
    }
  }
  for (std::size_t k = 0; k < count; ++k) {
    std::ranges::sort(near[k]);
    set.structures[k].neighbours.clear();
    for (const auto& [gap, other] : near[k]) {
      const std::string& name = set.structures[other].name;
      auto& known = set.structures[k].neighbours;
      if (std::ranges::find(known, name) == known.end()) known.push_back(name);
    }
  }
}

}  // namespace homolog
