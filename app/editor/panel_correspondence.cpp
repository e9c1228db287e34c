#include "app/editor/ui_context.h"
#include "app/editor/widgets.h"

namespace homolog {

void draw_correspondence_section(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  if (!ui.has_shape()) {
    explanation(theme, "Shows, during a drag, whether the landmarks stay in correspondence.");
    return;
  }
  static const std::vector<std::string> names{"Hue", "Stretch", "Moved", "Stiff", "Shape"};
  int overlay = static_cast<int>(ui.state.overlay);
  if (choice(theme, "overlay", names, overlay,
             {"Each landmark in the hue of its index",
              "Edge length against the template's: blue shorter, red longer",
              "How far each landmark is from the placed template",
              "Stiffness factor: dark soft, bright stiff; confirmed regions white",
              "Shape of the triangles: red thin or turned"}))
    out.change([overlay](EditorState& s) { s.overlay = static_cast<Overlay>(overlay); });
  draw_overlay_legend(ui);
  if (!ui.quality) {
    explanation(theme, "Measuring…");
    return;
  }
  const QualityFigures& q = *ui.quality;
  figure(theme, "Volume", format("%.2f ml", q.volume_ml), "Enclosed by the mesh; openings are capped flat");
  figure(theme, "Edge stretch",
         format("%.2f · %.2f · %.2f", q.stretch_low, q.stretch_median, q.stretch_high),
         "Edge length / the template's at this placement: 5 %, median, 95 %");
  figure(theme, "Smallest angle", format("%.1f\xc2\xb0", q.min_angle_deg), {},
         q.min_angle_deg < 10 ? palette::amber : palette::text);
  figure(theme, "Moved", format("%.1f mm, at most %.1f mm", q.moved_mean_mm, q.moved_max_mm),
         "Mean and largest distance of a landmark from the placed template");
  figure(theme, "Turned triangles", format("%zu", q.turned),
         "Over 90° from their normal on the template, carried along by the local rotations",
         q.turned > 0 ? palette::bad : palette::good);
  figure(theme, "Intersecting pairs", format("%zu", q.intersecting), "Triangles that pass through each other",
         q.intersecting > 0 ? palette::bad : palette::good);
}

}  // namespace homolog
