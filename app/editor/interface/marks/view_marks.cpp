#include "app/editor/interface/marks/view_marks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "app/editor/interface/marks/contour_marks.h"
#include "app/editor/interface/marks/landmark_marks.h"
#include "app/editor/interface/marks/measurement_marks.h"
#include "app/editor/state/icons.h"
#include "app/editor/state/views.h"
#include "app/editor/update/tools/tool.h"
#include "app/editor/widgets/widgets.h"
#include "core/base/pictures/caption_sizes.h"

namespace homolog {

namespace {

void draw_letters(const UiContext& ui, const ViewMap& map, ImDrawList& draw) {
  for (const Letters& one : letters_of(ui, map)) shadowed_text(draw, ui.theme.strong, one.at, palette::mark, one.text);
}

std::string length_text(double length_mm) {
  return length_mm >= 10 ? format("%.0f mm", length_mm) : format("%g mm", length_mm);
}

/// A text near a place, moved so far that the whole of it lies in the view.
void put_within(ImDrawList& draw, const Theme& theme, const RectPx& view, ImVec2 at, ImVec2 size,
                const std::string& text) {
  const float edge = theme.px(4), low_x = view.x + edge, low_y = view.y + edge;
  const float high_x = view.x + view.width - edge - size.x, high_y = view.y + view.height - edge - size.y;
  shadowed_text(draw, theme.strong, {std::max(low_x, std::min(at.x, high_x)), std::max(low_y, std::min(at.y, high_y))},
                palette::mark, text);
}

/// At the lower left, clear of the letter in the middle of the lower edge; above it where there is no room beside it.
void draw_scale_bar(const UiContext& ui, const ViewMap& map, ImDrawList& draw) {
  const RectPx& rect = map.rect();
  const Theme& theme = ui.theme;
  const double mm_per_px = map.mm_per_px(ui.state.look.crosshair_mm);
  const float x = rect.x + theme.px(12), aside = theme.px(8), tick = theme.px(4);
  float y = rect.y + rect.height - theme.px(14), longest_px = 0.25f * rect.width;
  if (ui.state.preferences.show.letters) {
    const Letters below = letters_of(ui, map)[3];
    const float text_px = text_size(theme.small, length_text(scale_bar_mm(mm_per_px, longest_px))).x;
    const float room = below.at.x - aside - text_px - aside - x;
    if (room >= 0.5f * longest_px)
      longest_px = std::min(longest_px, room);
    else
      y = below.at.y - theme.px(8);
  }
  const double length_mm = scale_bar_mm(mm_per_px, longest_px);
  const auto length_px = static_cast<float>(std::round(length_mm / mm_per_px));
  const float thick = theme.px(1);
  for (const auto& [shift, colour] : {std::pair(thick, IM_COL32(0, 0, 0, 160)), std::pair(0.0f, palette::mark)}) {
    draw.AddLine({x + shift, y + shift}, {x + length_px + shift, y + shift}, colour, thick);
    draw.AddLine({x + shift, y - tick + shift}, {x + shift, y + thick + shift}, colour, thick);
    draw.AddLine({x + length_px + shift, y - tick + shift}, {x + length_px + shift, y + thick + shift}, colour, thick);
  }
  shadowed_text(draw, theme.small, {x + length_px + aside, std::round(y - theme.small->FontSize / 2)}, palette::mark,
                length_text(length_mm));
}

/// Lines of the other two planes, in their hues, with a gap around the cross-hair's middle.
void draw_crosshair(const UiContext& ui, ViewKind kind, const ViewMap& map, ImDrawList& draw) {
  const auto middle = map.to_px(ui.state.look.crosshair_mm);
  if (!middle) return;
  const VolumeGeometry geometry = geometry_of(ui.document());
  const float gap_px = ui.theme.px(12);
  const RectPx& rect = map.rect();
  const float reach = rect.width + rect.height;
  for (const ViewKind other : slice_views) {
    if (other == kind) continue;
    const Vec3 along_mm = slice_view(ui.state, other, geometry).normal().cross(map.into_screen());
    const Eigen::Vector2d along(along_mm.dot(map.slice().right), along_mm.dot(map.slice().down));
    const Eigen::Vector2d unit = along.normalized();
    const ImU32 colour = with_alpha(view_hue(other), 0.55f);
    for (const double sign : {-1.0, 1.0})
      draw.AddLine(on_screen(*middle + sign * static_cast<double>(gap_px) * unit),
                   on_screen(*middle + sign * static_cast<double>(reach) * unit), colour, ui.theme.px(1));
  }
}

void draw_placement_handles(const UiContext& ui, const ViewMap& map, ImDrawList& draw) {
  const auto handles = placement_handles(map, *ui.shown().shape.points, ui.theme.scale);
  if (!handles) return;
  PlacePart lit = PlacePart::none;
  if (ui.state.pointer.drag) {
    if (const auto* drag = std::get_if<PlaceDrag>(&*ui.state.pointer.drag)) lit = drag->part;
  } else if (ui.state.pointer.hover &&
             map.rect().contains(ui.state.pointer.hover->x_px, ui.state.pointer.hover->y_px)) {
    lit = ui.state.pointer.hover->part;
  }
  const auto colour = [&](PlacePart part) { return lit == part ? palette::accent : with_alpha(palette::mark, 0.7f); };
  const auto radius = static_cast<float>(handles->radius_px);
  draw.AddCircle(on_screen(handles->centre_px), radius, colour(PlacePart::ring), 0,
                 lit == PlacePart::ring ? 2.0f : 1.5f);
  draw.AddCircleFilled(on_screen(handles->knob_px), ui.theme.px(6), IM_COL32(0x0E, 0x0F, 0x11, 255));
  draw.AddCircle(on_screen(handles->knob_px), ui.theme.px(6), colour(PlacePart::knob), 0, 2);
  const ImVec2 centre = on_screen(handles->centre_px);
  const float arm = ui.theme.px(6);
  draw.AddLine({centre.x - arm, centre.y}, {centre.x + arm, centre.y}, colour(PlacePart::body), 1.5f);
  draw.AddLine({centre.x, centre.y - arm}, {centre.x, centre.y + arm}, colour(PlacePart::body), 1.5f);
}

void draw_ring(ImDrawList& draw, const ViewMap& map, const Vec3& at_mm, double radius_mm, ImU32 colour) {
  const auto px = map.to_px(at_mm);
  if (px) draw.AddCircle(on_screen(*px), static_cast<float>(radius_mm / map.mm_per_px(at_mm)), colour, 0, 1.5f);
}

/// How far the gesture moved, what stopped it and what it does wrong: beside the pointer, within the view.
void draw_stroke_note(const UiContext& ui, const StrokeDrag& drag, bool stopped, const RectPx& view, ImDrawList& draw) {
  struct Line {
    ImFont* font;
    ImU32 colour;
    std::string text;
  };
  const double moved_mm = ui.snapshot().preview ? ui.snapshot().preview->moved_mm : 0;
  std::vector<Line> lines{
      {ui.theme.even_digits(ui.theme.strong), stopped ? palette::amber : palette::mark,
       format("%.1f mm%s", moved_mm, stopped ? "  stopped" : "")},
      {ui.theme.even_digits(ui.theme.small), palette::mark_dim, format("\xcf\x83 %.1f mm", drag.stroke.sigma_mm)}};
  const auto& figures = ui.work.quality.latest();
  if (figures && figures->intersecting > ui.state.found.intersecting_at_rest)
    lines.push_back({ui.theme.small, palette::amber, "passes through the opposite wall"});
  ImVec2 size{0, 0};
  for (const Line& line : lines) {
    const ImVec2 one = text_size(line.font, line.text);
    size = {std::max(size.x, one.x), size.y + one.y};
  }
  const float pad = ui.theme.px(6), right = ui.theme.px(20), below = ui.theme.px(12);
  const auto px = static_cast<float>(ui.state.pointer.hover->x_px),
             py = static_cast<float>(ui.state.pointer.hover->y_px);
  const auto low_x = static_cast<float>(view.x) + pad, low_y = static_cast<float>(view.y) + pad;
  const float high_x = low_x + static_cast<float>(view.width) - 2 * pad - size.x;
  const float high_y = low_y + static_cast<float>(view.height) - 2 * pad - size.y;
  ImVec2 at{px + right <= high_x ? px + right : px - right - size.x, std::min(py + below, high_y)};
  at = {std::max(low_x, std::min(at.x, high_x)), std::max(low_y, at.y)};
  draw.AddRectFilled({at.x - pad, at.y - pad / 2}, {at.x + size.x + pad, at.y + size.y + pad / 2},
                     IM_COL32(0x1A, 0x1C, 0x1F, 205), ui.theme.px(4));
  for (const Line& line : lines) {
    text_at(draw, line.font, at, line.colour, line.text);
    at.y += text_size(line.font, line.text).y;
  }
}

/// The gesture's hold on the surface, its σ as a ring, and what is said of it at the pointer.
void draw_stroke(const UiContext& ui, const StrokeDrag& drag, const ViewMap& map, ImDrawList& draw) {
  const bool stopped = ui.snapshot().preview && ui.snapshot().preview->stopped_by_guard;
  const ImU32 colour = stopped ? palette::amber : palette::mark;
  const Vec3 held = ui.snapshot().preview && ui.snapshot().preview->on ? *ui.snapshot().preview->on : drag.stroke.at;
  draw_ring(draw, map, held, drag.stroke.sigma_mm, with_alpha(colour, 0.55f));
  if (const auto px = map.to_px(held)) draw.AddCircleFilled(on_screen(*px), ui.theme.px(3), colour);
  if (ui.state.pointer.hover && drag.moved) draw_stroke_note(ui, drag, stopped, map.rect(), draw);
}

/// The finding that is looked at: its triangles, a ring, and what it is.
void draw_finding(const UiContext& ui, const ViewMap& map, ImDrawList& draw) {
  const ShownFinding& shown = *ui.state.found.finding;
  const Points& points = *ui.shown().shape.points;
  const auto& triangles = ui.structure()->the_template->topology->triangles();
  if (shown.finding.vertex >= points.rows()) return;
  const Vec3 at = points.row(shown.finding.vertex);
  const double off_mm = map.is_slice() ? std::abs(map.into_screen().dot(at - map.slice().centre)) : 0;
  const float alpha = off_mm <= slice_step_mm(geometry_of(ui.document()), map.into_screen()) ? 1.0f : 0.35f;
  const ImU32 colour = with_alpha(palette::amber, alpha);
  constexpr std::size_t most_faces = 200;
  for (std::size_t k = 0; !map.is_slice() && k < std::min(most_faces, shown.finding.faces.size()); ++k) {
    if (shown.finding.faces[k] >= triangles.rows()) continue;
    const auto corners = triangles.row(shown.finding.faces[k]);
    const auto a = map.to_px(points.row(corners[0])), b = map.to_px(points.row(corners[1])),
               c = map.to_px(points.row(corners[2]));
    if (a && b && c) draw.AddTriangle(on_screen(*a), on_screen(*b), on_screen(*c), colour, ui.theme.px(1.5f));
  }
  const auto px = map.to_px(at);
  if (!px) return;
  draw.AddCircle(on_screen(*px), ui.theme.px(14), IM_COL32(0, 0, 0, 160), 0, ui.theme.px(4));
  draw.AddCircle(on_screen(*px), ui.theme.px(14), colour, 0, ui.theme.px(2));
  if (map.is_slice()) return;
  const std::string text = finding_words(shown.finding.kind) +
                           (shown.of > 1 ? format(", %zu of %zu (J: next)", shown.number, shown.of) : "");
  const ImVec2 size = text_size(ui.theme.strong, text);
  put_within(draw, ui.theme, map.rect(), {on_screen(*px).x - size.x / 2, on_screen(*px).y + ui.theme.px(20)}, size,
             text);
}

/// What a press would do: the point that would be taken hold of, with σ or the brush around it.
void draw_hover(const UiContext& ui, const ViewMap& map, ImDrawList& draw) {
  const Hover& hover = *ui.state.pointer.hover;
  const ToolMarks marks = kind_of(ui.state.hand.tool).marks;
  const bool brush = marks == ToolMarks::brush_circle;
  if (brush && map.is_slice()) {
    // The circle paints what it covers, wherever its middle is.
    draw_ring(draw, map, *hover.p_mm, ui.state.hand.brush.radius_mm,
              with_alpha(palette::mark, hover.on_mesh ? 0.6f : 0.2f));
    return;
  }
  if (!hover.on_mesh) return;
  if (!brush && marks != ToolMarks::sigma_ring) return;
  const double radius_mm = brush ? ui.state.hand.brush.radius_mm : ui.state.hand.sigma_mm();
  draw_ring(draw, map, *hover.on_mesh, radius_mm, with_alpha(palette::mark, 0.35f));
  if (const auto px = map.to_px(*hover.on_mesh)) {
    draw.AddCircleFilled(on_screen(*px), ui.theme.px(4), palette::mark);
    draw.AddCircle(on_screen(*px), ui.theme.px(5), IM_COL32(0, 0, 0, 160));
  }
}

/// The name of a structure that the pointer is over and that is not worked on.
void draw_name_at_pointer(const UiContext& ui, const ViewMap& map, ImDrawList& draw) {
  const Hover& hover = *ui.state.pointer.hover;
  const Structure* structure = hover.structure.empty() ? nullptr : ui.document().structure(hover.structure);
  if (structure == nullptr) return;
  const Theme& theme = ui.theme;
  const std::string name = structure_name(*structure);
  const float side = theme.px(10), pad = theme.px(6), aside = theme.px(14);
  const ImVec2 text = text_size(theme.small, name), size{text.x + side + 3 * pad, text.y + theme.px(8)};
  const RectPx& rect = map.rect();
  const auto x = static_cast<float>(hover.x_px), y = static_cast<float>(hover.y_px);
  const ImVec2 low{std::floor(std::min(x + aside, rect.x + rect.width - size.x - pad)),
                   std::floor(std::min(y + aside, rect.y + rect.height - size.y - pad))};
  draw.AddRectFilled(low, {low.x + size.x, low.y + size.y}, IM_COL32(0x1A, 0x1C, 0x1F, 225), theme.px(4));
  const Rgb colour = structure_colour(*structure);
  colour_swatch(draw, theme, {low.x + pad, std::floor(low.y + (size.y - side) / 2)}, side,
                ImGui::ColorConvertFloat4ToU32({colour[0], colour[1], colour[2], 1}));
  text_at(draw, theme.small, {low.x + side + 2 * pad, low.y + theme.px(4)}, IM_COL32(0xE6, 0xE8, 0xEB, 255), name);
}

void draw_ruler(const UiContext& ui, const ViewMap& map, ImDrawList& draw) {
  const Ruler& ruler = *ui.state.hand.ruler;
  const auto from = map.to_px(ruler.from), to = map.to_px(ruler.to);
  if (!from || !to) return;
  const double half_step_mm = slice_step_mm(geometry_of(ui.document()), map.into_screen()) / 2;
  const auto near = [&](const Vec3& p) {
    return !map.is_slice() || std::abs(map.into_screen().dot(p - map.slice().centre)) <= half_step_mm;
  };
  const bool in_plane = near(ruler.from) && near(ruler.to);
  const ImU32 colour = with_alpha(palette::accent, in_plane ? 1.0f : 0.35f);
  draw.AddLine(on_screen(*from), on_screen(*to), colour, 1.5f * ui.theme.scale);
  for (const auto& end : {*from, *to}) draw.AddCircleFilled(on_screen(end), ui.theme.px(3), colour);
  if (!in_plane) return;
  // Beside its middle, and within the view also where that lies beyond it.
  const std::string text = format("%.1f mm", ruler.length_mm());
  const ImVec2 middle = on_screen((*from + *to) / 2), size = text_size(ui.theme.strong, text);
  put_within(draw, ui.theme, map.rect(), {middle.x + ui.theme.px(8), middle.y + ui.theme.px(4)}, size, text);
}

/// From a dot on the outline, which is to be taken hold of, an arrow the way that the guide's pull goes, with a bar
/// where it should end and the arrow's tip lies. A short way has an arrow of some length all the same, which begins
/// before the dot; in other slices it is faint.
void draw_guide_arrow(const UiContext& ui, const GuideStep& step, const ViewMap& map, ImDrawList& draw) {
  const auto from = map.to_px(pulled_from(step, ui.shown().mesh())), to = map.to_px(step.to_mm);
  if (!from || !to) return;
  const double off_mm = std::abs(map.into_screen().dot(step.to_mm - map.slice().centre));
  const bool here = off_mm <= slice_step_mm(geometry_of(ui.document()), map.into_screen());
  const ImU32 colour = with_alpha(palette::accent, here ? 1.0f : 0.35f), edge = IM_COL32(0, 0, 0, here ? 190 : 60);
  const Eigen::Vector2d way = *to - *from;
  const double length = way.norm(), head = ui.theme.px(11), shortest = ui.theme.px(36), bar = ui.theme.px(8);
  const float thick = ui.theme.px(3), rim = ui.theme.px(2);
  if (length > 0.5) {
    const Eigen::Vector2d along = way / length, across(-along.y(), along.x());
    const Eigen::Vector2d& tip = *to;
    const Eigen::Vector2d neck = tip - head * along, tail = tip - std::max(length, shortest) * along;
    const ImVec2 low = on_screen(neck + 0.6 * head * across), high = on_screen(neck - 0.6 * head * across);
    const ImVec2 left = on_screen(*to + bar * across), right = on_screen(*to - bar * across);
    draw.AddLine(on_screen(tail), on_screen(neck), edge, thick + rim);
    draw.AddLine(left, right, edge, thick + rim);
    draw.AddTriangle(on_screen(tip), low, high, edge, rim);
    draw.AddLine(on_screen(tail), on_screen(neck), colour, thick);
    draw.AddTriangleFilled(on_screen(tip), low, high, colour);
    draw.AddLine(left, right, colour, thick);
  }
  draw.AddCircleFilled(on_screen(*from), ui.theme.px(4), with_alpha(IM_COL32_WHITE, here ? 1.0f : 0.35f));
  draw.AddCircle(on_screen(*from), ui.theme.px(4.5f), edge, 0, ui.theme.px(1.5f));
}

void draw_hints(const UiContext& ui, ViewKind kind, ImDrawList& draw) {
  const Hints& hints = ui.state.preferences.hints;
  if (ui.state.hints_over || !ui.has_shape() || ui.state.pointer.drag || (ui.state.guide && ui.state.guide->shown))
    return;
  std::string text;
  if (kind == ViewKind::axial && !hints.dragged && kind_of(ui.state.hand.tool).stroke)
    text = "Drag the coloured outline to the organ's edge";
  else if (kind == ViewKind::sagittal && !hints.scrolled)
    text = "Turn the wheel to go through the slices";
  else if (kind == ViewKind::space && !hints.turned_camera)
    text = "Drag beside the mesh to turn it";
  if (text.empty()) return;
  const RectPx& rect = ui.layout.image(kind);
  ImFont& font = *ui.theme.body;
  const float pad_x = ui.theme.px(12), pad_y = ui.theme.px(7), wrap = rect.width - 4 * pad_x;
  const ImVec2 size = text_size(&font, in_lines(&font, text, wrap));
  const ImVec2 at{std::round(rect.x + (rect.width - size.x) / 2), rect.y + rect.height - ui.theme.px(44) - size.y};
  const ImVec2 low{at.x - pad_x, at.y - pad_y}, high{at.x + size.x + pad_x, at.y + size.y + pad_y};
  const float rounding = (font.FontSize + 2 * pad_y) / 2;
  draw.AddRectFilled(low, high, IM_COL32(0x1A, 0x1C, 0x1F, 225), rounding);
  draw.AddRect(low, high, with_alpha(palette::accent, 0.5f), rounding);
  text_at(draw, &font, at, palette::mark, text, wrap);
}

void draw_empty_state(const UiContext& ui, ViewKind kind, ImDrawList& draw) {
  const bool nothing = !ui.document().scan.image && !ui.has_shape();
  if (!nothing || kind != ViewKind::axial) return;
  const RectPx& rect = ui.layout.image(kind);
  const std::string title = "Nothing is open", text = "Ctrl+O opens an image, a case or a template";
  const float wrap = rect.width - ui.theme.px(16);
  const ImVec2 a = text_size(ui.theme.strong, title);
  const ImVec2 b = text_size(ui.theme.body, in_lines(ui.theme.body, text, wrap));
  const float x = rect.x + rect.width / 2, y = rect.y + rect.height / 2;
  text_at(draw, ui.theme.strong, {std::round(x - a.x / 2), y - ui.theme.px(20)}, palette::mark, title);
  text_at(draw, ui.theme.body, {std::round(x - b.x / 2), y + ui.theme.px(4)}, palette::mark_dim, text, wrap);
}

/// While it lives, marks are dark on light: over the ground of the 3D view in the light theme.
class MarksOnGround {
 public:
  explicit MarksOnGround(bool light) {
    if (!light) return;
    palette::mark = palette::text;
    palette::mark_dim = palette::dim;
    palette::mark_shadow = IM_COL32(255, 255, 255, 220);
  }
  ~MarksOnGround() { std::tie(palette::mark, palette::mark_dim, palette::mark_shadow) = before_; }
  MarksOnGround(const MarksOnGround&) = delete;
  MarksOnGround& operator=(const MarksOnGround&) = delete;

 private:
  std::tuple<ImU32, ImU32, ImU32> before_{palette::mark, palette::mark_dim, palette::mark_shadow};
};

}  // namespace

void draw_view_marks(const UiContext& ui, ViewKind kind, ImDrawList& draw) {
  const ViewMap map = view_map(ui.state, ui.layout, ui.document(), kind);
  const auto& show = ui.state.preferences.show;
  const bool nothing = !ui.document().scan.image && !ui.has_shape();
  if (nothing) return draw_empty_state(ui, kind, draw);
  {
    const MarksOnGround marks(!map.is_slice() && ui.state.preferences.light);
    if (show.crosshair && map.is_slice()) draw_crosshair(ui, kind, map, draw);
    if (ui.state.hand.ruler) draw_ruler(ui, map, draw);
    draw_contours(ui, map, draw);
    if (ui.has_shape()) {
      draw_landmarks(ui, map, draw);
      draw_measurement_marks(ui, map, draw);
      if (kind_of(ui.state.hand.tool).marks == ToolMarks::handles) draw_placement_handles(ui, map, draw);
      if (ui.state.found.finding) draw_finding(ui, map, draw);
    }
    if (show.letters) draw_letters(ui, map, draw);
    if (map.is_slice()) draw_scale_bar(ui, map, draw);
  }
  // In the 3D view, or in the one that fills the window: above its scale bar and the letters.
  if (kind == ui.state.look.maximised.value_or(ViewKind::space)) {
    const RectPx& rect = map.rect();
    const bool narrow = rect.width < ui.theme.px(420), above = map.is_slice() || (show.letters && narrow);
    // For a while a narrow view has a hint there.
    const bool hint = !map.is_slice() && !ui.state.hints_over && !ui.state.preferences.hints.turned_camera;
    if (!narrow || !hint) draw_view_legend(ui, rect, rect.y + rect.height - ui.theme.px(above ? 40 : 8), draw);
  }
  const auto& guide = ui.state.guide;
  const bool pulls = guide && guide->shown && guide->at < guide->steps.size() && ui.has_shape();
  if (pulls && guide->steps[guide->at].view == kind) draw_guide_arrow(ui, guide->steps[guide->at], map, draw);
  const auto* contour = ui.state.pointer.drag ? std::get_if<ContourDrag>(&*ui.state.pointer.drag) : nullptr;
  if (contour != nullptr && contour->view == kind) draw_contour_drag(ui, *contour, map, draw);
  const auto* stroke = ui.state.pointer.drag ? std::get_if<StrokeDrag>(&*ui.state.pointer.drag) : nullptr;
  if (stroke != nullptr && stroke->view == kind) draw_stroke(ui, *stroke, map, draw);
  if (!ui.state.pointer.drag && ui.state.pointer.hover && ui.state.pointer.hover->view == kind)
    draw_hover(ui, map, draw), draw_held_contour(ui, map, draw), draw_name_at_pointer(ui, map, draw);
  draw_hints(ui, kind, draw);
}

}  // namespace homolog
