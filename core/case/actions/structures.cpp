#include "core/case/actions/structures.h"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#include "core/base/member_list.h"
#include "core/case/actions/fields.h"
#include "core/case/placing.h"

namespace homolog {

namespace {

using Colour = std::array<std::uint8_t, 3>;

constexpr Names<Side, 3> body_sides{{{"none", Side::none}, {"left", Side::left}, {"right", Side::right}}};

/// A member of the action.
template <class Value, class Told = std::nullptr_t>
struct StructureRow {
  const char* key;  ///< in the line; empty: it does not stand there
  Value SetStructure::*of;
  Told told = nullptr;  ///< the member of a structure that gets the value; null: it is of a new structure
};
template <class Value>
StructureRow(const char*, Value SetStructure::*) -> StructureRow<Value>;
template <class Value, class Told>
StructureRow(const char*, Value SetStructure::*, Told Structure::*) -> StructureRow<Value, Told Structure::*>;

// In the order of the line.
constexpr auto structure_rows = std::make_tuple(
    StructureRow{"id", &SetStructure::id}, StructureRow{"name", &SetStructure::name, &Structure::name},
    StructureRow{"label", &SetStructure::label, &Structure::label},
    StructureRow{"layer", &SetStructure::layer, &Structure::layer},
    StructureRow{"colour", &SetStructure::colour, &Structure::colour},
    StructureRow{"confidence", &SetStructure::confidence, &Structure::confidence},
    StructureRow{"doubt", &SetStructure::doubt, &Structure::doubt},
    StructureRow{"side", &SetStructure::side, &Structure::side},
    StructureRow{"partner", &SetStructure::partner, &Structure::partner},
    StructureRow{"shared", &SetStructure::shared, &Structure::shared}, StructureRow{"template", &SetStructure::source},
    StructureRow{"placement", &SetStructure::placement}, StructureRow{"template_mark", &SetStructure::mark},
    StructureRow{"", &SetStructure::the_template});
static_assert(names_all<SetStructure>(structure_rows), "name each member of SetStructure once in structure_rows");

// How a member stands in a line, by its type.

template <class Value>
void spell_member(Fields& line, const char* key, std::optional<Value>& value) {
  line.optional(key, value);
}

void spell_member(Fields& line, const char* key, std::string& source) {
  line.optional(key, source, !source.empty());
}

void spell_member(Fields& line, const char* key, std::vector<double>& numbers) {
  line.optional(key, numbers, !numbers.empty());
}

void spell_member(Fields& line, const char* key, std::optional<Colour>& colour) {
  Fields::Json shades;
  if (colour) shades = *colour;
  line.optional(key, shades, colour.has_value());
  if (!line.reads() || shades.is_null()) return;
  const auto is_shade = [](const auto& shade) { return shade.is_number_unsigned() && shade <= 255; };
  if (!shades.is_array() || shades.size() != 3 || !std::all_of(shades.begin(), shades.end(), is_shade))
    throw Unreadable{"\"colour\" is not three whole numbers from 0 to 255"};
  colour = shades.get<Colour>();
}

void spell_member(Fields& line, const char* key, std::optional<Side>& side) {
  if (line.reads() ? !line.has(key) : !side.has_value()) return;
  Side of_body = side.value_or(Side::none);
  line.member(key, body_sides, of_body);
  side = of_body;
}

void spell_member(Fields& line, const char* key, std::optional<std::vector<SharedWith>>& shared) {
  if (line.reads() ? !line.has(key) : !shared.has_value()) return;
  Fields::Json json = shared ? shared_to_json(*shared) : Fields::Json();
  line.member(key, json);
  if (line.reads()) shared = shared_from_json(json);
}

void spell_member(Fields&, const char*, BesideValues<Template>&) {}

void spell_structure(Fields& line, SetStructure& action) {
  Fields structure = line.object("structure");
  structure.member("id", action.id);
  for_each_member(structure_rows, [&](const auto& row) {
    if (row.key != std::string_view("id")) spell_member(structure, row.key, action.*row.of);
  });
}

std::string quoted(const std::string& id) {
  return "\"" + excerpt(id) + "\"";
}

/// The structure at its place, with a mesh in the frame that is shown.
Result<Structure> begun(const SetStructure& action, const Document& document) {
  if (!action.the_template) return fail("structure", quoted(action.id) + " does not exist; give its template");
  const Template& the_template = *action.the_template;
  const Similarity placement = action.placement.value_or(in_the_middle(document.scan, the_template));
  if (auto usable = check_placement(placement, the_template.points); !usable) return fail(usable.error());
  Structure structure = new_structure(action.the_template, placement);
  structure.id = action.id;
  if (const Structure* first = document.structure()) structure.landmarks = first->landmarks;
  if (document.frame != 0) structure.set_shape(document.frame, shape_of_frame(structure, 0, document.frame));
  return structure;
}

template <class Value>
void tell(const std::optional<Value>& value, Value& told) {
  if (value) told = *value;
}

void tell(const std::optional<Colour>& colour, std::optional<Colour>& told) {
  if (colour) told = colour;
}

void tell(const std::optional<std::string>& partner, std::optional<std::string>& told) {
  if (partner) told = partner->empty() ? std::nullopt : partner;
}

void describe(const SetStructure& action, Structure& structure) {
  for_each_member(structure_rows, [&]<class Value, class Told>(const StructureRow<Value, Told>& row) {
    if constexpr (!std::is_same_v<Told, std::nullptr_t>) tell(action.*row.of, structure.*row.told);
  });
}

/// Errors: a partner, or one to share vertices with, that is no other structure of the case; a vertex that there is
/// not.
Result<void> check_relations(const SetStructure& action, const Template& own, const Document& document) {
  const auto other = [&](const std::string& id) {
    return id.empty() || id == action.id ? nullptr : document.structure(id);
  };
  if (action.partner && !action.partner->empty() && other(*action.partner) == nullptr)
    return fail("partner", quoted(*action.partner) + " is no other structure of the case");
  if (!action.shared) return {};
  const auto has = [](const Template& one, std::int32_t vertex) {
    return vertex >= 0 && vertex < one.topology->vertices();
  };
  for (const SharedWith& shared : *action.shared) {
    const Structure* with = other(shared.with);
    if (with == nullptr) return fail("shared", quoted(shared.with) + " is no other structure of the case");
    for (const auto& [a, b] : *shared.vertices)
      if (!has(own, a) || !has(*with->the_template, b))
        return fail("shared", "the vertices " + std::to_string(a) + ":" + std::to_string(b) +
                                  " are not both there; they are counted from 0");
  }
  return {};
}

/// Drops all that a structure knows of one that leaves the case.
void forget_structure(const std::string& id, Structure& structure) {
  if (structure.partner == id) structure.partner.reset();
  std::erase_if(structure.shared, [&](const SharedWith& shared) { return shared.with == id; });
}

bool knows_structure(const Structure& structure, const std::string& id) {
  return structure.partner == id || std::any_of(structure.shared.begin(), structure.shared.end(),
                                                [&](const SharedWith& shared) { return shared.with == id; });
}

Result<EditReport> apply_structure(const SetStructure& action, DocumentEdit& edit) {
  if (action.id.empty()) return fail("structure", "needs an id");
  if (action.layer && *action.layer < 0) return fail("layer", "must be 0 or more");
  if (action.confidence && !(*action.confidence >= 0 && *action.confidence <= 1))
    return fail("confidence", "must be from 0 to 1");
  if (edit.before.structure(action.id) == nullptr) {
    auto structure = begun(action, edit.before);
    if (!structure) return fail(structure.error());
    if (auto known = check_relations(action, *structure->the_template, edit.before); !known) return fail(known.error());
    describe(action, *structure);
    edit.after.structures.push_back(std::make_shared<const Structure>(std::move(*structure)));
    return EditReport{};
  }
  if (!action.source.empty() || action.placement)
    return fail("structure", quoted(action.id) + " exists already; give the new one another id");
  const Structure& own = *edit.before.structure(action.id);
  if (auto known = check_relations(action, *own.the_template, edit.before); !known) return fail(known.error());
  edit.after.change(action.id, [&](Structure& structure) { describe(action, structure); });
  return EditReport{};
}

Result<EditReport> apply_structure_removal(const RemoveStructure& action, DocumentEdit& edit) {
  if (action.id.empty() || edit.before.structure(action.id) == nullptr)
    return fail("structure", quoted(action.id) + " does not exist");
  if (edit.before.structures.size() == 1)
    return fail("structure", quoted(action.id) + " is the only one of this case, which keeps it; start a new case");
  std::erase_if(edit.after.structures, [&](const auto& structure) { return structure->id == action.id; });
  for (const auto& one : edit.before.structures)
    if (one->id != action.id && knows_structure(*one, action.id))
      edit.after.change(one->id, [&](Structure& structure) { forget_structure(action.id, structure); });
  return EditReport{};
}

}  // namespace

nlohmann::ordered_json shared_to_json(const std::vector<SharedWith>& shared) {
  auto json = Fields::Json::array();
  for (const SharedWith& one : shared) json.push_back({{"with", one.with}, {"vertices", text_of_pairs(*one.vertices)}});
  return json;
}

std::vector<SharedWith> shared_from_json(const nlohmann::ordered_json& json) {
  const auto unreadable = [] {
    return Unreadable{
        "\"shared\" is not a list of structures and vertices; give [{\"with\": \"s2\", \"vertices\": "
        "\"12:40 13:41\"}]"};
  };
  if (!json.is_array()) throw unreadable();
  std::vector<SharedWith> shared;
  for (const auto& one : json) {
    const auto text = [&](const char* key) -> const std::string& {
      const auto found = one.is_object() ? one.find(key) : one.end();
      if (!one.is_object() || found == one.end() || !found->is_string()) throw unreadable();
      return found->get_ref<const std::string&>();
    };
    auto pairs = pairs_of_text(text("vertices"));
    if (!pairs) throw unreadable();
    shared.push_back({text("with"), std::make_shared<const std::vector<VertexPair>>(std::move(*pairs))});
  }
  return shared;
}

namespace {

constexpr const char* set_structure_example =
    R"({"structure":{"id":"s2","name":"left kidney","label":"left kidney","layer":0,"colour":[96,165,214],"confidence":0.97,"doubt":"It is too small.","side":"left","partner":"s1","shared":[{"with":"s1","vertices":"12:40 13:41"}],"template":"kidney.ply","placement":{"rotation":[1,0,0,0],"scale":1,"translation":[12,-40,310]},"template_mark":[1.5,-2,0.25,10]}})";

constexpr bool example_has_each_key() {
  constexpr std::string_view example = set_structure_example;
  const auto stands_there = [&](std::string_view key) {
    for (std::size_t at = example.find(key); at != std::string_view::npos; at = example.find(key, at + 1))
      if (example[at - 1] == '"' && example.substr(at + key.size()).starts_with("\":")) return true;
    return false;
  };
  return std::apply([&](const auto&... row) { return ((*row.key == '\0' || stands_there(row.key)) && ...); },
                    structure_rows);
}
static_assert(example_has_each_key(), "put each member into the example; the schema is compared with it");

}  // namespace

const ActionKind<SetStructure>& action_kind(const SetStructure&) {
  static constexpr ActionKind<SetStructure> kind{
      .key = "structure",
      .example = set_structure_example,
      .meaning =
          "adds a structure: its template (a path as in the first line) and where it lies, what it is called, its "
          "label in the label map, its colour. `confidence` is the probability (0 to 1) that its mesh is right, and "
          "`doubt` a sentence that says why it has to be looked at. `side` is `left`, `right` or `none`, and `partner` "
          "the id of the same structure of the other side. `shared` names vertices that are one with those of another "
          "structure: the vertex here, then the one there, counted from 0. `template_mark` tells the template from "
          "others of its faces (above). All but the id and the template may be missing. The same id again, without "
          "template and placement, renames or recolours it. Lines of this structure have `\"of\":\"s2\"`",
      .needs_mesh = false,
      .name =
          [](const SetStructure& action) {
            return (action.source.empty() ? "change of " : "new structure ") + action.name.value_or(action.id);
          },
      .spell = spell_structure,
      .apply = apply_structure};
  return kind;
}

const ActionKind<RemoveStructure>& action_kind(const RemoveStructure&) {
  static constexpr ActionKind<RemoveStructure> kind{
      .key = "remove_structure",
      .example = R"({"remove_structure":"s2"})",
      .meaning = "takes a structure out of the case, and what others share with it; the last one stays",
      .needs_mesh = false,
      .name = [](const RemoveStructure& action) { return "removal of " + action.id; },
      .spell = [](Fields& line, RemoveStructure& action) { line.member("remove_structure", action.id); },
      .apply = apply_structure_removal};
  return kind;
}

}  // namespace homolog
