#include "core/case/actions/structures.h"

#include <algorithm>
#include <utility>

#include "core/case/actions/fields.h"
#include "core/case/placing.h"

namespace homolog {

namespace {

using Colour = std::array<std::uint8_t, 3>;

void spell_colour(Fields& line, std::optional<Colour>& colour) {
  Fields::Json shades;
  if (colour) shades = *colour;
  line.optional("colour", shades, colour.has_value());
  if (!line.reads() || shades.is_null()) return;
  const auto is_shade = [](const auto& shade) { return shade.is_number_unsigned() && shade <= 255; };
  if (!shades.is_array() || shades.size() != 3 || !std::all_of(shades.begin(), shades.end(), is_shade))
    throw Unreadable{"\"colour\" is not three whole numbers from 0 to 255"};
  colour = shades.get<Colour>();
}

void spell_structure(Fields& line, SetStructure& action) {
  Fields structure = line.object("structure");
  structure.member("id", action.id);
  structure.optional("name", action.name);
  structure.optional("label", action.label);
  structure.optional("layer", action.layer);
  spell_colour(structure, action.colour);
  structure.optional("confidence", action.confidence);
  structure.optional("doubt", action.doubt);
  structure.optional("template", action.source, !action.source.empty());
  structure.optional("placement", action.placement);
  structure.optional("template_mark", action.mark, !action.mark.empty());
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

void describe(const SetStructure& action, Structure& structure) {
  structure.name = action.name.value_or(structure.name);
  structure.label = action.label.value_or(structure.label);
  structure.layer = action.layer.value_or(structure.layer);
  if (action.colour) structure.colour = action.colour;
  structure.confidence = action.confidence.value_or(structure.confidence);
  structure.doubt = action.doubt.value_or(structure.doubt);
}

Result<EditReport> apply_structure(const SetStructure& action, DocumentEdit& edit) {
  if (action.id.empty()) return fail("structure", "needs an id");
  if (action.layer && *action.layer < 0) return fail("layer", "must be 0 or more");
  if (action.confidence && !(*action.confidence >= 0 && *action.confidence <= 1))
    return fail("confidence", "must be from 0 to 1");
  if (edit.before.structure(action.id) == nullptr) {
    auto structure = begun(action, edit.before);
    if (!structure) return fail(structure.error());
    describe(action, *structure);
    edit.after.structures.push_back(std::make_shared<const Structure>(std::move(*structure)));
    return EditReport{};
  }
  if (!action.source.empty() || action.placement)
    return fail("structure", quoted(action.id) + " exists already; give the new one another id");
  edit.after.change(action.id, [&](Structure& structure) { describe(action, structure); });
  return EditReport{};
}

Result<EditReport> apply_structure_removal(const RemoveStructure& action, DocumentEdit& edit) {
  if (action.id.empty() || edit.before.structure(action.id) == nullptr)
    return fail("structure", quoted(action.id) + " does not exist");
  if (edit.before.structures.size() == 1)
    return fail("structure", quoted(action.id) + " is the only one of this case, which keeps it; start a new case");
  std::erase_if(edit.after.structures, [&](const auto& structure) { return structure->id == action.id; });
  return EditReport{};
}

}  // namespace

const ActionKind<SetStructure>& action_kind(const SetStructure&) {
  static constexpr ActionKind<SetStructure> kind{
      .key = "structure",
      .example =
          R"({"structure":{"id":"s2","name":"left kidney","label":"left kidney","layer":0,"colour":[96,165,214],"confidence":0.97,"template":"kidney.ply","placement":{"rotation":[1,0,0,0],"scale":1,"translation":[12,-40,310]},"template_mark":[1.5,-2,0.25,10]}})",
      .meaning =
          "adds a structure: its template (a path as in the first line) and where it lies, what it is called, its "
          "label in the label map, its colour. `confidence` is the probability (0 to 1) that its mesh is right, and "
          "`doubt` a sentence that says why it has to be looked at. `template_mark` tells the template from others of "
          "its faces (above). All but the id and the template may be missing. "
          "The same id again, "
          "without template and placement, renames or recolours it. Lines of this structure have `\"of\":\"s2\"`",
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
      .meaning = "takes a structure out of the case; the last one stays",
      .needs_mesh = false,
      .name = [](const RemoveStructure& action) { return "removal of " + action.id; },
      .spell = [](Fields& line, RemoveStructure& action) { line.member("remove_structure", action.id); },
      .apply = apply_structure_removal};
  return kind;
}

}  // namespace homolog
