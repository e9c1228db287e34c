#include <cmath>

#include "app/editor/panels/sections.h"
#include "app/editor/panels/ui_context.h"
#include "app/editor/state/icons.h"
#include "app/editor/update/controls.h"
#include "app/editor/widgets/widgets.h"
#include "core/base/files/file_stem.h"
#include "core/base/text/listed.h"
#include "core/mesh/formats/formats.h"
#include "core/volume/formats/formats.h"
#include "core/volume/readers.h"

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// A name for the mended map, in the format of the one that was read, where that is written.
std::string mended_name(const fs::path& labels) {
  std::string ending = ".seg.nrrd";
  for (const std::string& known : label_map_endings())
    if (has_ending(labels, {known}) && !has_ending(labels, {ending})) ending = known;
  return file_stem(labels) + "-mended" + ending;
}

/// All structures of the case as files.
template <class Ask>
void draw_export_of_all(const UiContext& ui, const std::string& name, float width, const Ask& ask) {
  const Theme& theme = ui.theme;
  caption(theme, "All structures");
  const fs::path& labels = ui.labels().file;
  std::error_code ignored;
  const bool masks = fs::is_directory(labels, ignored);
  if (button(theme, masks ? "The masks, mended\xe2\x80\xa6" : "The label map, mended\xe2\x80\xa6",
             "The label map that you opened, with all that it holds, in its format and on its grid. What a repair "
             "proposes is in it, but not what you took back. A structure that you changed has the voxels within its "
             "mesh. All other voxels stay as they are",
             labels.empty() ? "Open the label map of this case first (Place)." : "", width))
    ask(masks ? FilePurpose::export_mended_masks : FilePurpose::export_mended_map,
        masks ? labels.filename().string() + "-mended" : mended_name(labels));
  if (button(theme, "A label map of the meshes\xe2\x80\xa6",
             "The voxels of the image within each mesh, with the names and colours of the list. Where two hold a voxel "
             "it goes to the first. As .dcm: a DICOM segmentation of the series that is open",
             ui.needs_volume(), width))
    ask(FilePurpose::export_structures_map, name + ".seg.nrrd");
  if (button(theme, "All meshes into a folder\xe2\x80\xa6", "A PLY for each structure, called as in the list", {},
             width))
    ask(FilePurpose::export_structures_meshes, name + "-meshes");
}

}  // namespace

/// Size, ground and captions of a picture of a view; true where one was changed.
bool draw_picture_options(const Theme& theme, PictureOptions& options) {
  const float half = (ImGui::GetContentRegionAvail().x - theme.px(4)) / 2;
  bool released = false, changed = false;
  double width = options.width, height = options.height;
  constexpr double least_px = 64, most_px = 8192;
  changed |= number_field(theme, "width", width, released,
                          {.per_px = 4,
                           .format = "%.0f",
                           .unit = "px wide",
                           .width_px = half,
                           .tip = "Width of the picture",
                           .limits = {.low = least_px, .high = most_px, .name = "The width", .whole = true}});
  ImGui::SameLine(0, theme.px(4));
  changed |= number_field(theme, "height", height, released,
                          {.per_px = 4,
                           .format = "%.0f",
                           .unit = "px high",
                           .width_px = half,
                           .tip = "Height of the picture",
                           .limits = {.low = least_px, .high = most_px, .name = "The height", .whole = true}});
  options.width = static_cast<int>(std::lround(width));
  options.height = static_cast<int>(std::lround(height));
  int ground = options.transparent ? 2 : options.light ? 1 : 0;
  caption(theme, "Ground");
  if (choice(theme, "ground", {"Dark ground", "Light", "Transparent"}, ground,
             {.tips = {"For the screen", "For paper", "What is not drawn on stays transparent"}})) {
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
  const std::string name = case_name(ui.snapshot().file, ui.document());
  const auto ask = [&](FilePurpose purpose, const std::string& file) {
    if (ui.state.look.playing) out.send(PlayFrames{false});
    out.send(ShowFileDialog{purpose, file});
  };
  const Structure* structure = active_structure(ui.state, *ui.snapshot().document);
  const std::size_t meshes = structure != nullptr ? structure->shapes.size() : 0;
  const bool of_all = meshes > 1 && ui.state.saving.export_all_frames;
  const std::string no_mesh = of_all ? "" : ui.needs_shape();
  if (meshes > 1) {
    caption(theme, "Frames to write");
    int all = ui.state.saving.export_all_frames ? 0 : 1;
    if (choice(theme, "frames", {format("All %zu", meshes), "This one"}, all,
               {.tips = {"Every frame that has a mesh, in files with the frame's number: \xe2\x80\xa6-frame-07.ply",
                         "The frame that is shown, in one file"}}))
      out.send(ExportAllFrames{all == 0});
  }
  if (button(theme, "Mesh…",
             "With the template's numbering, ready for a shape model: " +
                 listed(mesh_format_extensions(&MeshFormat::keeps_numbers), " or ") +
                 ". Without numbering: " + listed(mesh_format_extensions(&MeshFormat::keeps_numbers, false), " and ") +
                 ". Without faces: " + listed(mesh_format_extensions(&MeshFormat::has_faces, false), " and "),
             no_mesh, width))
    ask(FilePurpose::export_mesh, name + ".ply");
  const std::string refusal = no_mesh.empty() ? ui.needs_volume() : no_mesh;
  if (button(theme, "Label map…",
             "Voxels of the image whose centre is inside the mesh. As .dcm: a DICOM segmentation of the series that is "
             "open",
             refusal, width))
    ask(FilePurpose::export_label_map, name + "-label.nii.gz");
  if (ui.document().structures.size() > 1) draw_export_of_all(ui, name, width, ask);
  gap(theme, 4);
  caption(theme, "Picture");
  PictureOptions options = ui.state.saving.picture;
  int what = options.view ? static_cast<int>(*options.view) + 1 : 0;
  bool changed = choice(theme, "picture of", {"Window", "Ax", "Sag", "Cor", "3D"}, what,
                        {.tips = {"The whole window, as it is on the screen", "The axial view", "The sagittal view",
                                  "The coronal view", "The 3D view"}});
  options.view = what == 0 ? std::nullopt : std::optional(static_cast<ViewKind>(what - 1));
  if (options.view) changed |= draw_picture_options(theme, options);
  if (changed) out.send(SetPicture{options});
  if (button(theme, format("%s  Save the picture…", icon::camera), "PNG", {}, width))
    ask(FilePurpose::export_picture, name + ".png");
}

}  // namespace homolog
