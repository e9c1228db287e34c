#include <cmath>
#include <tuple>

#include "app/editor/panels/sections.h"
#include "app/editor/panels/ui_context.h"
#include "app/editor/state/icons.h"
#include "app/editor/update/controls.h"
#include "app/editor/widgets/widgets.h"
#include "app/editor/work/opening/sample.h"

namespace homolog {

namespace {

struct WindowPreset {
  const char* label;
  const char* tip;
  double centre, width;
};
constexpr std::array<WindowPreset, 3> ct_presets{{{"Bone", "400 ± 900 HU", 400, 1800},
                                                  {"Soft", "Soft tissue: 40 ± 200 HU", 40, 400},
                                                  {"Lung", "−600 ± 750 HU", -600, 1500}}};

void draw_volume_figures(const UiContext& ui) {
  const Volume& volume = *ui.document().scan.image;
  const auto& geometry = volume.geometry;
  const auto& d = geometry.dims;
  figure(ui.theme, "Image", std::filesystem::path(ui.document().scan.source).filename().string(),
         ui.document().scan.source);
  figure(ui.theme, "Voxels", format("%d \xc3\x97 %d \xc3\x97 %d", d[0], d[1], d[2]),
         format("%s, %s", voxel_type_name(volume.data),
                volume.modality.empty() ? "kind unknown" : volume.modality.c_str()));
  figure(ui.theme, "Spacing",
         format("%.3g \xc3\x97 %.3g \xc3\x97 %.3g mm", geometry.spacing_mm.x(), geometry.spacing_mm.y(),
                geometry.spacing_mm.z()));
}

void draw_window_presets(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const auto& volume = ui.document().scan.image;
  // Fat and air lie below zero, which no other modality stores.
  const bool ct = volume && (volume->modality == "CT" || (volume->range_min < -100 && volume->range_max > 150));
  const std::string refusal = !volume ? ui.needs_volume() : ct ? "" : "Only for CT images: their values are in HU.";
  const double centre = (ui.state.look.window_low + ui.state.look.window_high) / 2;
  const double window_width = ui.state.look.window_high - ui.state.look.window_low;
  figure(theme, "Window", format("%.4g \xc2\xb1 %.4g", centre, window_width / 2),
         "Centre and half width of the grey values shown. A right-drag in a slice changes them");
  const float width = (ImGui::GetContentRegionAvail().x - 3 * theme.px(4)) / 4;
  for (const WindowPreset& preset : ct_presets) {
    if (button(theme, preset.label, preset.tip, refusal, width))
      out.send(SetWindow{preset.centre - preset.width / 2, preset.centre + preset.width / 2});
    ImGui::SameLine(0, theme.px(4));
  }
  if (button(theme, "Auto",
             "The window that the file asks for. Else soft tissue for a CT, and tissue without background for an MR",
             ui.needs_volume(), width)) {
    const auto [low, high] = default_window(*volume);
    out.send(SetWindow{low, high});
  }
}

/// Which frame of a cine the label map belongs to, and the way there.
void draw_labels_frame(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const int shown = shown_frame(ui.state, ui.document());
  const auto& of = ui.labels().frame;
  const char* const tip = "The label map holds one frame. It is shown there only";
  if (!of)
    figure(theme, "Belongs to", !ui.labels().volume ? "none" : "every frame",
           "A label map of one frame is shown at its frame");
  else if (figure_link(theme, "Belongs to", format("frame %d", *of), format("%s. Click to go there", tip),
                       *of == shown ? palette::text : palette::amber)) {
    out.send(SeekFrame{*of});
    out.send(ShowFrame{*of});
  }
  if (button(theme, "It is of this frame", format("The label map belongs to frame %d, which is shown", shown),
             !ui.labels().volume ? "Overlay a label map first."
             : !of               ? "The label map holds every frame."
             : *of == shown      ? "It belongs to this frame already."
                                 : "",
             ImGui::GetContentRegionAvail().x))
    out.send(SetLabelsFrame{shown});
}

/// Which layer is shown, of a map that has several.
void draw_labels_layer(const UiContext& ui, Outbox& out) {
  const ShownLabels& labels = ui.labels();
  if (labels.layers.size() < 2) return;
  std::string tip =
      format("The segments of this map overlap, so they lie in %zu layers. One is shown, and a fit goes to it",
             labels.layers.size());
  for (std::size_t k = 0; k < labels.values.size(); ++k)
    tip += (k == 0 ? ": " : ", ") + labels.label_name(labels.values[k]);
  double layer = static_cast<double>(labels.layer) + 1;
  bool released = false;
  if (slider(ui.theme, "Layer", layer, {1, static_cast<double>(labels.layers.size()), "%.0f", "", false, true}, tip,
             released))
    out.send(ShowLabelsLayer{static_cast<std::size_t>(std::lround(layer)) - 1});
}

}  // namespace

void draw_case_section(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const auto& document = ui.document();
  if (document.scan.image) {
    draw_volume_figures(ui);
    gap(theme, 0);
    draw_window_presets(ui, out);
  } else {
    explanation(theme, "No image is open. Open a DICOM folder, NIfTI, NRRD or MetaImage file, or drop one here.");
  }
  gap(theme, 0);
  const float half = (ImGui::GetContentRegionAvail().x - theme.px(8)) / 2;
  if (button(theme, std::string(icon::open) + "  Open…", "Image, case or template (Ctrl+O)", {}, half))
    out.send(ShowFileDialog{FilePurpose::open, {}});
  ImGui::SameLine();
  if (button(theme, std::string(icon::save) + "  Save as…", "Continue the case under another name (Ctrl+Shift+S)", {},
             half))
    out.send(SaveCase{true});
  const std::size_t unsaved = ui.state.unsaved_found;
  if (button(theme, unsaved == 0 ? "Unsaved cases…" : format("Unsaved cases (%zu)…", unsaved),
             "Cases that were open when the program ended without saving. Recover or delete them",
             ButtonOptions{.width_px = half, .primary = unsaved > 0}))
    out.send(ShowRecovery{});
  ImGui::SameLine();
  if (button(theme, "First steps…", "The first case and its guide: five pulls that fit a kidney", {}, half))
    out.send(ShowGuide{true});
  if (button(theme, "Sample: a real heart",
             "An MR scan with an expert's label map, and the ventricle's template to fit to it (Sunnybrook, CC0)", {},
             ImGui::GetContentRegionAvail().x))
    out.send(OpenRequested{sample_request()});
  if (!document.scan.image) return;
  bool linear = ui.state.preferences.linear;
  if (toggle(theme, "Smooth voxels", linear, "Interpolates between voxels. Off shows the voxels as they are"))
    out.send(InterpolateImage{linear});
  bool radiological = ui.state.preferences.radiological;
  if (toggle(theme, "Radiological", radiological, "Shows the patient's right side on the left of the screen"))
    out.send(ShowRadiological{radiological});
  bool own = ui.state.look.own_planes;
  if (toggle(
          theme, "The image's own planes", own, "Slices lie as they were acquired, not along the patient's axes",
          is_oblique(document.scan.image->geometry) ? "" : "The image was acquired along the patient's axes already."))
    out.send(ShowOwnPlanes{own});
  bool linked = ui.state.preferences.linked_zoom;
  if (toggle(theme, "Linked zoom", linked, "Ctrl and the wheel zoom all three slices together"))
    out.send(LinkZoom{linked});
  bool light = ui.state.preferences.light;
  if (toggle(theme, "Light window", light, "Dark text on a light ground. Images stay as they are"))
    out.send(UseLightTheme{light});

  rule(theme);
  // The same rows with a label map and without one: what lies below stays where it is when one is opened.
  figure(theme, "Labels", ui.labels().volume ? ui.labels().name : "none");
  draw_labels_layer(ui, out);
  double opacity = 100 * ui.state.look.label_opacity;
  bool released = false;
  if (slider(theme, "Opacity", opacity, {0, 100, "%.0f", "%", false}, "Of the label map over the image", released,
             ui.labels().volume ? "" : "Overlay a label map first."))
    out.send(SetLabelOpacity{opacity / 100});
  ShownParts parts = ui.state.preferences.show;
  if (toggle(
          theme, "Label's surface in 3D", parts.label_surface,
          "The smooth surface of the label that a fit would go to (Place), seen through, to compare the mesh with (U)",
          ui.labels().volume ? "" : "Overlay a label map first."))
    out.send(ShowParts{parts});
  const float width = ImGui::GetContentRegionAvail().x;
  if (document.scan.image->frames > 1) draw_labels_frame(ui, out);
  if (ui.labels().volume) {
    if (button(theme, "Remove the overlay", "The file is not changed", {}, width)) out.send(CloseLabels{});
  } else if (button(theme, "Overlay a label map…", "Shown over the slices in colours", {}, width)) {
    out.send(ShowFileDialog{FilePurpose::open_labels, {}});
  }
}

}  // namespace homolog
