#include "app/editor/panels/sections.h"
#include "app/editor/panels/ui_context.h"
#include "app/editor/state/files/file_extensions.h"
#include "app/editor/update/controls.h"
#include "app/editor/widgets/widgets.h"
#include "core/base/text/listed.h"
#include "core/catalogue/catalogue.h"

namespace homolog {

namespace {

/// "kidney (built in, mirrored)"
std::string template_name(const std::string& source, bool mirrored) {
  const auto built_in = built_in_organ(source);
  const std::string name =
      built_in ? std::string(organ_name(*built_in)) : std::filesystem::path(source).filename().string();
  if (built_in) return name + (mirrored ? " (built in, mirrored)" : " (built in)");
  return name + (mirrored ? " (mirrored)" : "");
}

/// The file that the template is kept in, or the name of a built-in one.
std::string template_source(const UiContext& ui) {
  const std::string saved = ui.snapshot().kept.template_file.string();
  return saved.empty() ? ui.structure()->the_template->source : saved;
}

}  // namespace

std::string template_in_words(const UiContext& ui) {
  return ui.structure() != nullptr ? template_name(template_source(ui), ui.on_screen.template_is_mirrored())
                                   : "none yet";
}

void draw_template_section(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  if (ui.structure() != nullptr) {
    const Template& the_template = *ui.structure()->the_template;
    const std::string source = template_source(ui);
    figure(theme, "Template", template_name(source, ui.on_screen.template_is_mirrored()), source);
    figure(theme, "Vertices", format("%ld", static_cast<long>(the_template.topology->vertices())));
    figure(theme, "Triangles", format("%ld", static_cast<long>(the_template.topology->triangles().rows())));
    figure(theme, "Surface",
           format("%s, genus %d", the_template.topology->closed() ? "closed" : "open", the_template.topology->genus()),
           "Openings count as closed flat. Genus is the number of tunnels");
  } else {
    explanation(theme, "The template is the mesh that every case starts from. Take a built-in one or load your own.");
  }
  gap(theme, 0);
  const float third = (ImGui::GetContentRegionAvail().x - 2 * theme.px(4)) / 3;
  static constexpr std::array<std::pair<const char*, Organ>, 3> built_ins{
      {{"Kidney", Organ::kidney}, {"Vertebra", Organ::vertebra}, {"Ventricle", Organ::ventricle}}};
  for (std::size_t i = 0; i < built_ins.size(); ++i) {
    if (i > 0) ImGui::SameLine(0, theme.px(4));
    if (button(theme, built_ins[i].first, "Start again with this built-in template", {}, third))
      out.send(open_template(built_in_source(built_ins[i].second)));
  }
  if (button(theme, "Load a template…", "A mesh: " + listed(mesh_extensions(), " or "), {},
             ImGui::GetContentRegionAvail().x))
    out.send(ShowFileDialog{FilePurpose::open_template, {}});
  if (button(theme, "Mirror left and right",
             "Takes the template of the other side, with the same numbering. The mesh goes back to the placed template",
             ui.needs_shape(), ImGui::GetContentRegionAvail().x))
    out.apply(MirrorTemplate{});
  if (button(theme, "Save the template…", "As PLY, with the stiffness, regions and landmarks as they are now",
             ui.needs_shape(), ImGui::GetContentRegionAvail().x))
    out.send(ShowFileDialog{FilePurpose::export_template, case_name(ui.snapshot().file, ui.document()) + "-template"});
  draw_template_making(ui, out);
  if (!ui.has_shape()) return;
  draw_regions(ui, out);
  draw_template_landmarks(ui, out);
}

}  // namespace homolog
