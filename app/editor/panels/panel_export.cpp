#include <algorithm>

#include "app/editor/panels/ui_context.h"
#include "app/editor/update/controls.h"
#include "app/editor/widgets/icons.h"
#include "app/editor/widgets/widgets.h"
#include "core/base/listed.h"
#include "core/mesh/formats/formats.h"

namespace homolog {

/// Size, ground and captions of a picture of a view; true where one was changed.
bool draw_picture_options(const Theme& theme, PictureOptions& options) {
  const float half = (ImGui::GetContentRegionAvail().x - theme.px(4)) / 2;
  bool released = false, changed = false;
  double width = options.width, height = options.height;
  changed |= number_field(theme, "width", width, 4, "%.0f", "px wide", half, "Width of the picture", released);
  ImGui::SameLine(0, theme.px(4));
  changed |= number_field(theme, "height", height, 4, "%.0f", "px high", half, "Height of the picture", released);
  options.width = static_cast<int>(std::clamp(width, 64.0, 8192.0));
  options.height = static_cast<int>(std::clamp(height, 64.0, 8192.0));
  int ground = options.transparent ? 2 : options.light ? 1 : 0;
  caption(theme, "Ground");
  if (choice(theme, "ground", {"Dark ground", "Light", "Transparent"}, ground,
             {"For the screen", "For paper", "What is not drawn on stays transparent"})) {
    options.transparent = ground == 2;
    options.light = ground == 1;
    changed = true;
  }
  changed |= toggle(theme, "Captions", options.captions, "Letters of the sides, scale bar, names");
  return changed;
}

void draw_export_section(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const float width = ImGui::GetContentRegionAvail().x;
  const std::string name = case_name(ui.snapshot.file, ui.document());
  const auto ask = [&](FilePurpose purpose, const std::string& file) {
    if (ui.state.playing) out.send(PlayFrames{false});
    out.send(ShowFileDialog{purpose, file});
  };
  if (button(theme, "Mesh…",
             "With the template's numbering, ready for a shape model: " +
                 listed(mesh_format_extensions(&MeshFormat::keeps_numbers), " or ") +
                 ". Without numbering: " + listed(mesh_format_extensions(&MeshFormat::keeps_numbers, false), " and ") +
                 ". Without faces: " + listed(mesh_format_extensions(&MeshFormat::has_faces, false), " and "),
             ui.needs_shape(), width))
    ask(FilePurpose::export_mesh, name + ".ply");
  const std::string refusal = ui.needs_shape().empty() ? ui.needs_volume() : ui.needs_shape();
  if (button(theme, "Label map…", "Voxels of the image whose centre is inside the mesh", refusal, width))
    ask(FilePurpose::export_label_map, name + "-label.nii.gz");
  gap(theme, 4);
  caption(theme, "Picture");
  PictureOptions options = ui.state.picture;
  int what = options.view ? static_cast<int>(*options.view) + 1 : 0;
  bool changed = choice(theme, "picture of", {"Window", "Ax", "Sag", "Cor", "3D"}, what,
                        {"The whole window, as it is on the screen", "The axial view", "The sagittal view",
                         "The coronal view", "The 3D view"});
  options.view = what == 0 ? std::nullopt : std::optional(static_cast<ViewKind>(what - 1));
  if (options.view) changed |= draw_picture_options(theme, options);
  if (changed) out.send(SetPicture{options});
  if (button(theme, format("%s  Save the picture…", icon::camera), "PNG", {}, width))
    ask(FilePurpose::export_picture, name + ".png");
}

}  // namespace homolog
