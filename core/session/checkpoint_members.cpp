#include "core/session/checkpoint_members.h"

#include <span>
#include <type_traits>

#include "core/base/pictures/colour.h"
#include "core/case/action_json.h"
#include "core/case/actions/contours.h"
#include "core/case/actions/fields.h"
#include "core/case/actions/structures.h"
#include "core/case/members.h"
#include "core/case/packed.h"
#include "core/template/other_side.h"
#include "core/template/template_mark.h"

namespace homolog {

namespace {

using Json = nlohmann::ordered_json;
using Shapes = std::map<int, std::shared_ptr<const Shape>>;
using Structures = std::vector<std::shared_ptr<const Structure>>;
using ContourSets = std::vector<std::shared_ptr<const ContourSet>>;
using Colour = std::optional<std::array<std::uint8_t, 3>>;

Json packed_array(const auto& array) {
  return packed(std::span(array.data(), static_cast<std::size_t>(array.size())));
}

template <class Array>
std::shared_ptr<const Array> unpacked_array(const Json& value, Eigen::Index rows, Eigen::Index columns) {
  const auto numbers = unpacked<double>(value.get_ref<const std::string&>(), static_cast<std::size_t>(rows * columns));
  if (!numbers) throw Unusable{};
  return std::make_shared<const Array>(Eigen::Map<const Array>(numbers->data(), rows, columns));
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
    auto other_side = make_template(mirrored_with_names(to_mesh_file(*now)), now->source);
    if (!other_side) throw Unusable{};
    now = *other_side;
  }
  std::vector<Landmark> landmarks;
  for (const Json& landmark : changes.at("landmarks"))
    landmarks.push_back({landmark.at("name").get<std::string>(), *unpacked_array<Vec3>(landmark.at("at"), 3, 1)});
  return landmarks == now->landmarks ? now : with_landmarks(*now, std::move(landmarks));
}

// A member that is newer than checkpoints is left out where it is empty: so a case without it keeps its bytes, and its
// older checkpoints hold.

bool left_out(const auto&) {
  return false;
}

bool left_out(const ContourSets& contours) {
  return contours.empty();
}

bool left_out(const Side& side) {
  return side == Side::none;
}

bool left_out(const std::optional<std::string>& text) {
  return !text;
}

bool left_out(const std::vector<SharedWith>& shared) {
  return shared.empty();
}

// Members of a document and of what it holds are written and read by their types [members.h].

/// Writes members that a checkpoint keeps. Points that are those of an earlier member are written as its name.
class MemberWriter {
 public:
  MemberWriter(const Document& start, const CaseTemplates& templates) : document_(start), templates_(templates) {}

  template <Described Owner>
  Json value(const Owner& owner) {
    Json json = Json::object();
    for_each_member(members_of(owner), [&](const auto& member) {
      if (member.kept() && !left_out(owner.*member.of)) json[member.key] = value(owner.*member.of);
      note(member.key, owner.*member.of);
    });
    return json;
  }

 private:
  void note(const char*, const auto&) {}
  void note(const char* key, const std::shared_ptr<const Points>& points) { earlier_.emplace_back(key, points); }

  template <class Value>
  requires(!Described<Value>) Json value(const Value& one) {
    if constexpr (std::is_enum_v<Value>)
      return static_cast<int>(one);
    else
      return one;
  }
  Json value(const Colour& colour) { return colour ? Json(hex_of(*colour)) : Json(); }
  Json value(const std::optional<std::string>& text) { return text ? Json(*text) : Json(); }
  Json value(const std::vector<SharedWith>& shared) { return shared_to_json(shared); }
  Json value(const Similarity& placement) { return to_json(placement); }
  Json value(const std::map<std::string, Vec3>& landmarks) {
    Json json = Json::object();
    for (const auto& [name, at] : landmarks) json[name] = packed_array(at);
    return json;
  }
  Json value(const std::shared_ptr<const VertexScalars>& values) {
    return values ? Json(packed_array(*values)) : Json();
  }
  Json value(const std::shared_ptr<const Points>& points) {
    if (!points) return {};
    for (const auto& [key, known] : earlier_)
      if (known == points) return Json{{"as", key}};
    return packed_array(*points);
  }
  Json value(const std::shared_ptr<const Regions>& regions) {
    Json list = Json::array();
    for (const Region& region : regions->list)
      list.push_back({{"name", region.name}, {"factor", region.factor}, {"colour", hex_of(region.colour)}});
    return {{"list", std::move(list)},
            {"of_vertex", packed_array(regions->of_vertex)},
            {"vertices", regions->of_vertex.size()}};
  }
  Json value(const std::shared_ptr<const Template>& now) {
    if (start_ != nullptr) return template_changes(*start_->the_template, *now);
    const auto begun = templates_.load(now->source);
    if (!begun) throw Unusable{};
    Json changes = template_changes(**begun, *now);
    changes["source"] = templates_.name_of(now->source);
    changes["mark"] = template_mark(**begun);
    return changes;
  }
  Json value(const std::shared_ptr<const Volume>&) { return {}; }  // the first line says it
  Json value(const ContourSets& contours) {
    Json json = Json::array();
    for (const auto& set : contours)
      json.push_back({{"id", set->id},
                      {"name", set->name},
                      {"frame", set->frame},
                      {"off_mm", set->off_mm},
                      {"outside", set->outside},
                      {"curves", curves_to_json(set->curves)}});
    return json;
  }
  Json value(const Shapes& shapes) {
    Json json = Json::array();
    for (const auto& [frame, shape] : shapes) {
      earlier_.clear();
      json.push_back(value(*shape));
      json.back()["frame"] = frame;
    }
    return json;
  }
  Json value(const Structures& structures) {
    Json json = Json::array();
    for (const auto& structure : structures) {
      start_ = document_.structure(structure->id);
      json.push_back(value(*structure));
    }
    return json;
  }

  const Document& document_;  ///< the start of the case
  const CaseTemplates& templates_;
  const Structure* start_ = nullptr;  ///< the structure that is written, as it was then; null: it was not there
  std::vector<std::pair<const char*, std::shared_ptr<const Points>>> earlier_;
};

/// Reads what MemberWriter wrote, in the same order. A value that is missing or of another kind is thrown.
class MemberReader {
 public:
  MemberReader(const Document& start, const CaseTemplates& templates) : document_(start), templates_(templates) {}

  template <Described Owner>
  void read(const Json& json, Owner& owner) {
    for_each_member(members_of(owner), [&](const auto& member) {
      if (member.kept() && (json.contains(member.key) || !left_out(std::decay_t<decltype(owner.*member.of)>{})))
        read(json.at(member.key), owner.*member.of);
      else if (member.origin == Origin::derived)
        derive(owner);
      note(member.key, owner.*member.of);
    });
  }

 private:
  void note(const char*, const auto&) {}
  void note(const char* key, const std::shared_ptr<const Points>& points) { earlier_[key] = points; }
  void derive(Shape& shape) { shape.placed = std::make_shared<const Points>(shape.placement.apply(template_->points)); }
  void derive(const auto&) {}

  template <class Value>
  requires(!Described<Value>) void read(const Json& json, Value& one) {
    if constexpr (std::is_enum_v<Value>)
      one = static_cast<Value>(json.get<int>());
    else
      one = json.get<Value>();
  }
  void read(const Json& json, Colour& colour) {
    if (json.is_null()) return colour.reset();
    colour = colour_from_hex(json.get<std::string>());
    if (!colour) throw Unusable{};
  }
  void read(const Json& json, std::optional<std::string>& text) { text = json.get<std::string>(); }
  void read(const Json& json, std::vector<SharedWith>& shared) { shared = shared_from_json(json); }
  void read(const Json& json, Similarity& placement) {
    const auto read = similarity_from_json(json);
    if (!read) throw Unusable{};
    placement = *read;
  }
  void read(const Json& json, std::map<std::string, Vec3>& landmarks) {
    landmarks.clear();
    for (const auto& [name, at] : json.items()) landmarks[name] = *unpacked_array<Vec3>(at, 3, 1);
  }
  void read(const Json& json, std::shared_ptr<const VertexScalars>& values) {
    values = json.is_null() ? nullptr : unpacked_array<VertexScalars>(json, template_->points.rows(), 1);
  }
  void read(const Json& json, std::shared_ptr<const Points>& points) {
    if (json.is_object())
      points = earlier(json.at("as").get<std::string>());
    else
      points = json.is_null() ? nullptr : unpacked_array<Points>(json, template_->points.rows(), 3);
  }
  void read(const Json& json, std::shared_ptr<const Regions>& regions) {
    auto now = std::make_shared<Regions>();
    for (const Json& region : json.at("list")) {
      const auto colour = colour_from_hex(region.at("colour").get<std::string>());
      if (!colour) throw Unusable{};
      now->list.push_back({region.at("name").get<std::string>(), region.at("factor").get<double>(), *colour});
    }
    auto of_vertex = unpacked<std::uint8_t>(json.at("of_vertex").get_ref<const std::string&>(),
                                            json.at("vertices").get<std::size_t>());
    if (!of_vertex) throw Unusable{};
    now->of_vertex = std::move(*of_vertex);
    regions = std::move(now);
  }
  void read(const Json& json, std::shared_ptr<const Template>& now) {
    now = template_ = changed_template(template_, json);
  }
  void read(const Json&, std::shared_ptr<const Volume>&) {}
  void read(const Json& json, ContourSets& contours) {
    contours.clear();
    for (const Json& one : json) {
      ContourSet set{one.at("id").get<std::string>(), one.at("name").get<std::string>(),
                     one.at("frame").get<int>(),      one.at("off_mm").get<double>(),
                     one.at("outside").get<bool>(),   curves_from_json(one.at("curves"))};
      contours.push_back(std::make_shared<const ContourSet>(std::move(set)));
    }
  }
  void read(const Json& json, Shapes& shapes) {
    shapes.clear();
    for (const Json& one : json) {
      earlier_.clear();
      Shape shape;
      read(one, shape);
      shapes.emplace(one.at("frame").get<int>(), std::make_shared<const Shape>(std::move(shape)));
    }
  }
  void read(const Json& json, Structures& structures) {
    structures.clear();
    for (const Json& one : json) {
      template_ = begun_with(one);
      Structure structure;
      read(one, structure);
      structures.push_back(std::make_shared<const Structure>(std::move(structure)));
    }
  }
  /// The template with which a structure began.
  std::shared_ptr<const Template> begun_with(const Json& structure) {
    const std::string id = structure.at("id").get<std::string>();
    if (id.empty()) throw Unusable{};
    if (const Structure* start = document_.structure(id)) return start->the_template;
    auto read = templates_.load(templates_.source_of(structure.at("template").at("source").get<std::string>()));
    if (!read) throw Unusable{};
    const Json& kept = structure.at("template");
    // Where it is another one, the line that adds it says so.
    if (kept.contains("mark")) {
      const auto same = check_template_mark(kept.at("mark").get<TemplateMark>(), **read);
      if (!same || !same->empty()) throw Unusable{};
    }
    return *read;
  }
  std::shared_ptr<const Points> earlier(const std::string& key) const {
    const auto found = earlier_.find(key);
    if (found == earlier_.end()) throw Unusable{};
    return found->second;
  }

  const Document& document_;  ///< the start of the case
  const CaseTemplates& templates_;
  std::shared_ptr<const Template> template_;  ///< of the structure that is read
  std::map<std::string, std::shared_ptr<const Points>> earlier_;
};

}  // namespace

Json members_to_json(const Document& start, const Document& document, const CaseTemplates& templates) {
  return MemberWriter(start, templates).value(document);
}

Document members_from_json(const Json& json, const Document& start, const CaseTemplates& templates) {
  Document document = start;
  MemberReader(start, templates).read(json, document);
  return document;
}

}  // namespace homolog
