#include <algorithm>
#include <cmath>

#include "app/editor/panels/sections.h"
#include "app/editor/panels/ui_context.h"
#include "app/editor/state/icons.h"
#include "app/editor/widgets/widgets.h"

// The contours that were drawn of the structure, and the fit to them.

namespace homolog {

namespace {

constexpr float contour_row_units = 56, most_listed_contours = 4;

/// "S 12.3" for a curve in a slice, else how many curves there are.
std::string where_in_words(const ContourSet& set) {
  if (set.curves.size() > 1) return format("%zu curves", set.curves.size());
  const auto [centre, normal] = plane_of(set.curves.front());
  Eigen::Index axis = 0;
  constexpr double along = 0.999;
  if (normal.cwiseAbs().maxCoeff(&axis) < along) return set.curves.front().closed ? "closed" : "open";
  Vec3 direction = Vec3::Zero();
  direction[axis] = centre[axis] < 0 ? -1 : 1;
  return format("%s %.1f", direction_letters(direction).c_str(), std::abs(centre[axis]));
}

Vec3 middle_of(const ContourSet& set) {
  Vec3 sum = Vec3::Zero();
  double count = 0;
  for (const Contour& curve : set.curves)
    for (const Vec3& p : curve.points) sum += p, count += 1;
  return sum / count;
}

std::string contour_tip(const ContourSet& set) {
  std::size_t points = 0, open = 0;
  for (const Contour& curve : set.curves) points += curve.points.size(), open += curve.closed ? 0U : 1U;
  std::string tip = format("%s\n%zu points", set.name.c_str(), points);
  if (open > 0) tip += open == set.curves.size() ? ", open" : format(", %zu open curves", open);
  return tip + ". Click: goes there in all views";
}

/// The curve of a set that has one, closed or opened.
SetContours turned_to(const ContourSet& set, bool closed) {
  auto curves = std::make_shared<std::vector<Contour>>(set.curves);
  curves->front().closed = closed;
  return {.id = set.id, .curves = std::move(curves), .curve = 0};
}

void draw_contour(const UiContext& ui, const ContourSet& set, float width, Outbox& out) {
  const Theme& theme = ui.theme;
  const Part part(set.id, "contour");
  const bool shown = !ui.state.look.hidden_contours.contains(set.id);
  const bool one = set.curves.size() == 1;  // its button closes or opens it
  const float side = theme.px(24), line = theme.px(26), buttons = (one ? 3 : 2) * side;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const AreaState row = area(theme, "row", {width - buttons, side}, contour_tip(set));
  if (row.clicked) out.send(LookAt{middle_of(set)});
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  if (row.hovered) draw.AddRectFilled(at, {at.x + width, at.y + side}, with_alpha(palette::accent, 0.12f), theme.px(3));
  const float text_y = std::floor(at.y + (side - ImGui::GetFontSize()) / 2);
  const std::string where = where_in_words(set);
  const float where_px = ImGui::CalcTextSize(where.c_str()).x;
  text_at(draw, {at.x + width - buttons - where_px - theme.px(4), text_y}, palette::dim, where);
  text_at(draw, {at.x + theme.px(4), text_y}, shown ? palette::text : palette::faint,
          shortened(set.name.empty() ? set.id : set.name, width - buttons - where_px - theme.px(16)));
  if (one) {
    const Contour& curve = set.curves.front();
    ImGui::SetCursorScreenPos({at.x + width - buttons, at.y});
    if (icon_button(theme, icon::outline, "closed",
                    curve.closed
                        ? "It is closed. Click: opens it between its last point and its first. One step to undo"
                        : "It is open. Click: joins its last point to its first. One step to undo",
                    curve.points.size() < 3 ? "A curve of two points has nothing to close." : "", curve.closed, 24))
      out.apply(turned_to(set, !curve.closed));
  }
  ImGui::SetCursorScreenPos({at.x + width - 2 * side, at.y});
  if (icon_button(theme, shown ? icon::eye : icon::eye_shut, "eye", shown ? "Hides it in all views" : "Shows it", {},
                  false, 24))
    out.send(ShowContours{{set.id}, !shown});
  ImGui::SetCursorScreenPos({at.x + width - side, at.y});
  if (icon_button(theme, icon::close, "remove", "Removes it from the case. One step to undo", {}, false, 24))
    out.apply(RemoveContours{set.id});
  ImGui::SetCursorScreenPos({at.x, at.y + line});
  const float number_px = theme.px(84);
  const float chosen_px = width - number_px - theme.px(4);
  ImGui::BeginChild("side", {chosen_px, theme.px(28)});
  int outside = set.outside ? 1 : 0;
  if (choice(theme, "side", {"Boundary", "Outside"}, outside,
             {.tips = {"The curve is the organ's boundary: the mesh goes through it",
                       "The organ lies inside of the curve, somewhere: what of the mesh lies beyond it is pushed in"}}))
    out.apply(SetContours{.id = set.id, .outside = outside == 1});
  ImGui::EndChild();
  ImGui::SameLine(0, theme.px(4));
  CaseNumber off(ui, "off " + set.id, set.off_mm);
  bool released = false;
  const bool changed =
      number_field(theme, "off", off.value, released,
                   {.per_px = 0.05,
                    .unit = "mm",
                    .width_px = number_px,
                    .tip = "How far the curve may lie off the boundary, mm (standard deviation). At 0 the "
                           "mesh goes through it. Drag, or click to type",
                    .height_units = 28,
                    .limits = {.low = 0, .high = 50, .name = "The distance"}});
  off.settle(
      changed, released, [&](double value) { return SetContours{.id = set.id, .off_mm = value}; }, out);
  ImGui::SetCursorScreenPos({at.x, at.y + theme.px(contour_row_units) + theme.px(4)});
}

/// The structures of a file that was opened.
void draw_offered(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const OfferedContours& offered = ui.state.automatic.offered;
  if (!offered.read) return;
  const float width = ImGui::GetContentRegionAvail().x;
  caption(theme, ("In " + shortened(offered.file, width - theme.px(40))).c_str());
  std::vector<const ContourRoi*> drawn;
  for (const ContourRoi& roi : offered.read->rois)
    if (!roi.contours.empty()) drawn.push_back(&roi);
  const float rows = std::min(static_cast<float>(drawn.size()), 6.0f);
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, 0});
  ImGui::BeginChild("offered", {0, rows * theme.px(26)});
  const float inner = ImGui::GetContentRegionAvail().x;
  for (const ContourRoi* roi : drawn) {
    const Part part(roi->name, "offered");
    ImGui::PushID(roi->number);
    const std::string tip = ui.structure() == nullptr ? "Load a template first (Template)"
                                                      : format(
                                                            "%zu curves. Click: adds them to the case. One step "
                                                            "to undo",
                                                            roi->contours.size());
    if (list_row(theme, roi->name.empty() ? format("Structure %d", roi->number) : roi->name, false,
                 {inner, theme.px(26)}, tip)
            .clicked &&
        ui.structure() != nullptr)
      out.send(AddContours{roi->number});
    ImGui::PopID();
  }
  ImGui::EndChild();
  ImGui::PopStyleVar();
  if (button(theme, "Close this list", "Forgets the file. What was added stays in the case", {}, width))
    out.send(CloseContours{});
}

std::string contour_fit_refusal(const UiContext& ui, bool any) {
  if (!ui.has_shape()) return ui.needs_shape();
  if (!any) return "Draw a contour in this frame first, or open some.";
  if (ui.work.contour_fits.busy() || ui.work.fitter.busy()) return "A fit is running.";
  if (ui.state.automatic.between_contours == BetweenCurves::label && !ui.on_screen.labels_here())
    return "Open a label map first, or choose Shape between the contours.";
  if (ui.state.automatic.between_contours == BetweenCurves::image) return ui.needs_volume();
  return {};
}

void draw_contour_fit(const UiContext& ui, bool any, Outbox& out) {
  const Theme& theme = ui.theme;
  caption(theme, "Between the contours");
  int between = static_cast<int>(ui.state.automatic.between_contours);
  if (choice(theme, "between contours", {"Shape", "Image", "Label"}, between,
             {.tips = {"Between the contours the mesh follows the template's shape",
                       "Between the contours the mesh goes to the edges that the image shows, as a snap does",
                       "Between the contours the mesh goes to the label map's label (Place)"}}))
    out.send(SetBetweenContours{static_cast<BetweenCurves>(between)});
  if (button(
          theme, "Fit to contours",
          "Fits the template anew to all contours of this frame. Where they and a label or the image disagree, the "
          "contours count. One step to undo",
          ButtonOptions{
              .refusal = contour_fit_refusal(ui, any), .width_px = ImGui::GetContentRegionAvail().x, .primary = true}))
    out.send(FitContours{});
  std::optional<WorkShown> running;
  if (ui.work.contour_fits.busy())
    running = {
        "Fitting", ui.work.contour_fits.fraction(),
        ui.snapshot().preview ? "The mesh goes back to how it was (Escape)" : "The mesh stays as it is (Escape)"};
  const auto& last = ui.state.found.fitted_contours;
  const bool known = last && ui.has_shape() && last->contours == ui.structure()->contours &&
                     last->points->rows() == ui.committed_shape().points->rows() &&
                     *last->points == *ui.committed_shape().points;
  const std::string said = known ? format(
                                       "The contours lie %.2f mm from the mesh on average, 95 %% of them within "
                                       "%.2f mm.",
                                       last->off.mean_mm, last->off.p95_mm)
                                 : "";
  if (work_area(theme, said, running)) out.send(CancelContourFit{});
}

}  // namespace

std::string contours_in_words(const UiContext& ui) {
  if (ui.structure() == nullptr || ui.structure()->contours.empty()) return {};
  return format("%zu", ui.structure()->contours.size());
}

void draw_contours_section(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  draw_offered(ui, out);
  std::vector<const ContourSet*> here;
  std::size_t elsewhere = 0;
  if (ui.structure() != nullptr) {
    for (const auto& set : ui.structure()->contours) {
      if (set->frame == ui.document().frame)
        here.push_back(set.get());
      else
        ++elsewhere;
    }
  }
  if (here.empty()) {
    explanation(theme,
                "Draw around the organ in a few slices: hold Ctrl and drag with the left button (or take the tool "
                "Contour, A). The mesh follows.");
  } else {
    const float rows = std::min(static_cast<float>(here.size()), most_listed_contours);
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, 0});
    ImGui::BeginChild("contours", {0, rows * theme.px(contour_row_units + 4)});
    const float width = ImGui::GetContentRegionAvail().x;
    for (const ContourSet* set : here) draw_contour(ui, *set, width, out);
    ImGui::EndChild();
    ImGui::PopStyleVar();
  }
  if (elsewhere > 0) explanation(theme, format("%zu more in other frames.", elsewhere));
  if (button(theme, "Open contours\xe2\x80\xa6",
             "A DICOM structure set (RTSTRUCT), curves of 3D Slicer (.mrk.json) or lines of VTP", {},
             ImGui::GetContentRegionAvail().x))
    out.send(ShowFileDialog{FilePurpose::open_contours, {}});
  draw_contour_fit(ui, !here.empty(), out);
}

}  // namespace homolog
