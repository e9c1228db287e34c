#include "app/editor/update/commands/looks/setting.h"

#include <array>
#include <cstdint>

#include "app/editor/update/commands/spelling.h"
#include "core/phantom/phantom.h"

namespace homolog {

namespace {

constexpr std::array column_names{"study", "name", "group", "state", "distance"};
constexpr std::array between_names{"shape", "image", "label"};
constexpr std::array paint_names{"factor", "region", "smooth", "fill"};
constexpr std::array fill_names{"region", "curvature"};
constexpr std::array study_picture_names{"gallery", "modes"};

}  // namespace

void spell_value(Fields& line, const char* name, bool& value) {
  line.member(name, value);
}
void spell_value(Fields& line, const char* name, int& value) {
  line.member(name, value);
}
void spell_value(Fields& line, const char* name, double& value) {
  line.member(name, value);
}
void spell_value(Fields& line, const char* name, std::size_t& value) {
  line.member(name, value);
}
void spell_value(Fields& line, const char* name, std::string& value) {
  line.member(name, value);
}
void spell_value(Fields& line, const char* name, std::filesystem::path& value) {
  line.member(name, value);
}
void spell_value(Fields& line, const char* name, std::vector<std::string>& value) {
  line.member(name, value);
}
void spell_value(Fields& line, const char* name, Vec3& value) {
  line.member(name, value);
}
void spell_value(Fields& line, const char* name, std::optional<std::string>& value) {
  line.or_null(name, value);
}
void spell_value(Fields& line, const char* name, std::optional<std::size_t>& value) {
  line.or_null(name, value);
}
void spell_value(Fields& line, const char* name, LookFrom& value) {
  spell_choice(line, name, side_names, value);
}
void spell_value(Fields& line, const char* name, Organ& value) {
  spell_choice(line, name, organ_names, value);
}
void spell_value(Fields& line, const char* name, Alignment& value) {
  spell_choice(line, name, alignment_names, value);
}
void spell_value(Fields& line, const char* name, CaseColumn& value) {
  spell_choice(line, name, column_names, value);
}
void spell_value(Fields& line, const char* name, BetweenCurves& value) {
  spell_choice(line, name, between_names, value);
}
void spell_value(Fields& line, const char* name, std::optional<ViewKind>& value) {
  spell_choice_or_null(line, name, view_names, value);
}

// Each names all members at once: a new one does not compile before it is spelled too.

void spell_value(Fields& line, const char*, ShownParts& parts) {
  auto& [outline, surface, planes, glyphs, wireframe, crosshair, letters, label_surface, plane_look] = parts;
  line.member("outline", outline);
  line.member("surface", surface);
  line.member("planes", planes);
  line.member("glyphs", glyphs);
  line.member("wireframe", wireframe);
  line.member("crosshair", crosshair);
  line.member("letters", letters);
  line.optional("label_surface", label_surface, label_surface);
  int look = static_cast<int>(plane_look);
  line.optional("plane_look", look, plane_look != PlaneLook::translucent);
  if (line.reads()) plane_look = static_cast<PlaneLook>(std::clamp(look, 0, 2));
}

void spell_value(Fields& line, const char*, BrushSettings& brush) {
  auto& [radius_mm, paints, region, erases, fill_by, fill_tolerance_per_mm, stiffness_factor, soft, hold] = brush;
  line.member("radius_mm", radius_mm);
  spell_choice(line, "paints", paint_names, paints);
  line.member("region", region);
  line.member("erases", erases);
  spell_choice(line, "fill_by", fill_names, fill_by);
  line.member("fill_tolerance_per_mm", fill_tolerance_per_mm);
  line.member("stiffness_factor", stiffness_factor);
  line.member("soft", soft);
  line.member("hold", hold);
}

void spell_value(Fields& line, const char*, FitSettings& fit) {
  auto& [label, all_labels, closing_mm, as_placed, partial, model, beyond] = fit;
  line.member("label", label);
  line.optional("all_labels", all_labels, all_labels);
  line.or_null("closing_mm", closing_mm);
  line.member("as_placed", as_placed);
  static constexpr std::array model_names{"none", "study", "file"};
  if (!line.reads() || line.has("model")) spell_choice(line, "model", model_names, model);
  line.optional("partial", partial, partial);
  line.optional("beyond", beyond);
}

void spell_value(Fields& line, const char*, TemplateSettings& settings) {
  static constexpr std::array tunnel_names{"automatic", "keep", "number"};
  line.member("label", settings.label);
  line.optional("all_labels", settings.all_labels, settings.all_labels);
  line.member("tube", settings.tube);
  line.optional("part", settings.part, settings.part);
  line.optional("faced", settings.faced.values, !settings.faced.values.empty());
  line.optional("facing", settings.faced.kept, !settings.faced.kept);
  Fields mask = line.object("organ_options");
  mask.count("vertices", settings.mask.vertices);
  mask.or_null("closing_mm", settings.mask.closing_mm);
  mask.or_null("opening_mm", settings.mask.opening_mm);
  spell_choice(mask, "tunnels", tunnel_names, settings.mask.genus.kind);
  mask.count("genus", settings.mask.genus.genus);
  Fields tube = line.object("tube_options");
  tube.count("rings", settings.tube_options.rings);
  tube.count("sectors", settings.tube_options.sectors);
  tube.member("capped", settings.tube_options.capped);
  line.member("outer_label", settings.outer_label);
  line.member("axis_by_ruler", settings.axis_by_ruler);
}

void spell_value(Fields& line, const char*, PictureOptions& options) {
  spell_choice_or_null(line, "view", view_names, options.view);
  line.member("width", options.width);
  line.member("height", options.height);
  line.member("transparent", options.transparent);
  line.optional("light", options.light, options.light);
  line.optional("captions", options.captions, !options.captions);
  std::string study = options.study ? study_picture_names[static_cast<std::size_t>(*options.study)] : "";
  line.optional("study", study, options.study.has_value());
  if (!line.reads()) return;
  options.study.reset();
  for (std::size_t k = 0; k < study_picture_names.size(); ++k)
    if (study == study_picture_names[k]) options.study = static_cast<StudyPicture>(k);
}

void spell_value(Fields& line, const char*, std::optional<RegionNaming>& naming) {
  std::optional<std::string> name, to;
  if (naming) {
    name = naming->rename.name;
    to = naming->rename.to;
  }
  line.or_null("name", name);
  line.or_null("to", to);
  if (line.reads() && name) naming = RegionNaming{{*name, to.value_or("")}, true};
}

void spell_value(Fields& line, const char*, std::optional<PanelEdit>& number) {
  std::optional<std::string> control;
  std::optional<double> value;
  if (number) {
    control = number->control;
    value = number->value;
  }
  line.or_null("control", control);
  line.or_null("value", value);
  if (line.reads() && control && value) number = PanelEdit{*control, *value};
}

void spell_value(Fields& line, const char*, std::optional<CaseTextEdit>& edit) {
  if (!edit) edit.emplace();
  line.member("field", edit->field);
  line.member("text", edit->text);
}

void spell_value(Fields& line, const char*, std::optional<GalleryVertex>& place) {
  bool any = place.has_value();
  line.member("any", any);
  if (!any) return;
  if (!place) place.emplace();
  std::int64_t vertex = place->vertex;
  line.member("shape", place->shape);
  line.member("vertex", vertex);
  place->vertex = vertex;
}

}  // namespace homolog
