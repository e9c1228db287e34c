#include "app/editor/interface/marks/contour_marks.h"

#include <cmath>

#include "app/editor/interface/marks/landmark_marks.h"
#include "app/editor/state/views.h"
#include "app/editor/widgets/widgets.h"

namespace homolog {

namespace {

/// A curve in a view: dashed where it only lies outside of the organ.
void draw_curve(const ViewMap& map, const Contour& curve, bool dashed, float thick, ImU32 colour, ImDrawList& draw) {
  constexpr double dash_px = 7;
  double along_px = 0;
  const std::size_t count = curve.points.size(), pieces = curve.closed ? count : count - 1;
  auto from = map.to_px(curve.points.front());
  for (std::size_t k = 0; k < pieces; ++k) {
    const auto to = map.to_px(curve.points[(k + 1) % count]);
    const double length_px = from && to ? (*to - *from).norm() : 0;
    if (from && to && (!dashed || std::fmod(along_px + length_px / 2, 2 * dash_px) < dash_px))
      draw.AddLine(on_screen(*from), on_screen(*to), colour, thick);
    along_px += length_px;
    from = to;
  }
}

/// Where a curve that lies in another plane goes through a slice.
void draw_crossings(const UiContext& ui, const ViewMap& map, const Contour& curve, ImU32 colour, ImDrawList& draw) {
  const Vec3 normal = map.into_screen();
  const double at_mm = normal.dot(map.slice().centre);
  const std::size_t count = curve.points.size(), pieces = curve.closed ? count : count - 1;
  for (std::size_t k = 0; k < pieces; ++k) {
    const Vec3 &a = curve.points[k], &b = curve.points[(k + 1) % count];
    const double before = normal.dot(a) - at_mm, after = normal.dot(b) - at_mm;
    if ((before < 0) == (after < 0)) continue;
    if (const auto px = map.to_px(a + before / (before - after) * (b - a))) {
      draw.AddCircleFilled(on_screen(*px), ui.theme.px(3), IM_COL32(0, 0, 0, 160));
      draw.AddCircleFilled(on_screen(*px), ui.theme.px(2), colour);
    }
  }
}

}  // namespace

void draw_contours(const UiContext& ui, const ViewMap& map, ImDrawList& draw) {
  const float thick = ui.theme.px(1.5f);
  for (const auto& structure : ui.document().structures) {
    if (!ui.state.look.structures.shows(structure->id)) continue;
    const bool active = structure.get() == ui.structure();
    const ImU32 colour = with_alpha(palette::contour, active ? 1.0f : 0.5f);
    for (const auto& set : structure->contours) {
      if (set->frame != ui.document().frame || ui.state.look.hidden_contours.contains(set->id)) continue;
      for (const Contour& curve : set->curves) {
        if (map.is_slice() && !lies_in_slice(map, curve, geometry_of(ui.document()))) {
          draw_crossings(ui, map, curve, colour, draw);
          continue;
        }
        draw_curve(map, curve, set->outside, thick + ui.theme.px(1.5f), IM_COL32(0, 0, 0, 110), draw);
        draw_curve(map, curve, set->outside, thick, colour, draw);
      }
    }
  }
}

void draw_held_contour(const UiContext& ui, const ViewMap& map, ImDrawList& draw) {
  const bool draws = ui.state.hand.tool == MouseTool::contour || ImGui::GetIO().KeyCtrl;
  if (!draws || ui.structure() == nullptr) return;
  const Hover& hover = *ui.state.pointer.hover;
  const auto held = contour_at({map, hover.x_px, hover.y_px, ui.theme.scale}, ui.document(), *ui.structure(),
                               ui.state.look.hidden_contours);
  if (!held) return;
  if (const auto px = map.to_px(held->at)) {
    draw.AddCircleFilled(on_screen(*px), ui.theme.px(4), palette::contour);
    draw.AddCircle(on_screen(*px), ui.theme.px(5), IM_COL32(0, 0, 0, 160));
  }
}

void draw_contour_drag(const UiContext& ui, const ContourDrag& drag, const ViewMap& map, ImDrawList& draw) {
  if (drag.points.size() > 1)
    draw_curve(map, {.points = drag.points, .closed = drag.at_start}, false, ui.theme.px(2), palette::contour, draw);
  if (const auto px = map.to_px(drag.points.front()))
    draw.AddCircle(on_screen(*px), ui.theme.px(drag.at_start ? 7 : 5), palette::contour, 0, ui.theme.px(1.5f));
}

}  // namespace homolog
