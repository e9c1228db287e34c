#include "app/editor/panels/ui_context.h"
#include "app/editor/state/icons.h"
#include "app/editor/widgets/widgets.h"

namespace homolog {

namespace {

/// Whether the look of the boundary is learned from the study's cases that are done.
bool draw_learning(const UiContext& ui, SnapSettings& snap) {
  const std::size_t cases = cases_to_learn(ui.state.models.study, ui.snapshot().file).size();
  const bool changed =
      toggle(ui.theme, "Learn from done cases", snap.learn,
             "A snap then looks for the boundary as it appears at each vertex in the study's done cases (the first "
             "eight), not for any edge",
             cases == 0                             ? "Open a study and mark cases as done (Models)."
             : snap.polarity != Polarity::automatic ? "Choose Auto above first. A learned boundary needs no polarity."
                                                    : "");
  if (!snap.learn || cases == 0) return changed;
  if (ui.work.study_appearance.busy())
    explanation(ui.theme, format("Learning: %.0f %%", 100 * ui.work.study_appearance.fraction()));
  else
    explanation(ui.theme,
                format("Learned from %d of %zu done cases.", ui.work.study_appearance.learned().cases, cases));
  return changed;
}

bool draw_snap_settings(const UiContext& ui, SnapSettings& snap) {
  const Theme& theme = ui.theme;
  bool released = false, changed = false;
  double strength = 100 * snap.strength;
  changed |= slider(theme, "Strength", strength, {0, 100, "%.0f", "%", false},
                    "At 0 % nothing moves. At 100 % the image decides wherever it shows an edge", released);
  snap.strength = strength / 100;
  changed |= slider(theme, "Search", snap.reach_mm, {1, 30, "%.1f", "mm", true},
                    "How far from the mesh a snap looks for the boundary, on both sides", released);
  int polarity = static_cast<int>(snap.polarity);
  caption(theme, "Inside the edge");
  if (choice(
          theme, "polarity", {"Auto", "Bright", "Dark", "Either"}, polarity,
          {.tips = {
               "Finds by itself whether the organ is brighter or darker. In a cine it takes the nearest edited frame",
               "The organ is brighter than what surrounds it", "The organ is darker than what surrounds it",
               "Any edge, bright or dark inside"}})) {
    snap.polarity = static_cast<Polarity>(polarity);
    changed = true;
  }
  changed |= draw_learning(ui, snap);
  changed |= toggle(theme, "Snap while dragging", snap.with_strokes,
                    "Snaps the part that you pull or grab while you drag it (Shift+N). Both are one step to undo");
  changed |= toggle(theme, "Show confidence", snap.show_confidence,
                    "After a snap, colours show how clear the image edge is at each vertex, until the mesh changes");
  return changed;
}

/// What the last snap found. Each figure has its place before the first snap and after the mesh has changed, so that
/// nothing below moves.
void draw_last_snap(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  static const SnapFound none;
  const bool snapped = ui.state.found.snapped.has_value();
  const SnapFound& found = snapped ? *ui.state.found.snapped : none;
  const bool known = ui.state.found.confidence != nullptr;
  const char* const unknown = "not known";
  figure(
      theme, "Confidence", known ? format("%.0f %%", 100 * found.mean_confidence) : unknown,
      "How clear the image edges are on which the mesh lies. It does not say that the mesh is right. 100 %: as clear "
      "as usual in this image. It is known until the mesh changes",
      !known           ? palette::text
      : found.doubtful ? palette::amber
                       : palette::good);
  const std::size_t unclear = ui.state.found.unclear_edges.size();
  const std::string tip = "Places where the snap saw no clear boundary. Check whether the mesh is right there";
  if (unclear == 0)
    figure(theme, "No clear edge", known ? "nowhere" : unknown, tip);
  else if (figure_link(theme, "No clear edge", format(unclear == 1 ? "%zu place" : "%zu places", unclear),
                       tip + ". Click to go to the next one", palette::amber))
    out.send(ShowFinding{FindingKind::unclear});
  figure(theme, "Held",
         !snapped             ? unknown
         : found.held.empty() ? "nothing"
                              : found.held,
         "Placed landmarks, contours and what was pulled since the last fit stay where you put them. The lock of a "
         "landmark, Confirm (C) with Alt, and a contour's mm let go");
  figure(theme, "Moved", snapped ? format("%.1f mm in %.2f s", found.moved_mm, found.seconds) : unknown,
         "Mean distance that the vertices moved, and how long it took");
}

}  // namespace

void draw_snap(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const Part part("Snap");  // its Strength is not that of the tool Relax
  rule(theme);
  caption(theme, "Snap to the image");
  const float width = ImGui::GetContentRegionAvail().x;
  const float cancel_width = theme.px(72);
  if (button(
          theme, std::string(icon::snap) + "  Snap the whole mesh",
          "Draws the mesh to the boundary in the image. What is confirmed, placed landmarks and what was pulled since "
          "the last fit stay; contours draw it. The key N snaps only the part under the pointer, as wide as "
          "\xcf\x83. If the pointer is not on the mesh, N snaps all",
          ui.work.snaps.busy() ? "A snap is running." : ui.needs_volume(), width - cancel_width - theme.px(4)))
    out.send(SnapMesh{});
  ImGui::SameLine(0, theme.px(4));
  if (button(theme, "Cancel", "The mesh is not changed", ui.work.snaps.busy() ? "" : "No snap is running.",
             cancel_width))
    out.send(CancelSnap{});
  SnapSettings snap = ui.state.automatic.snap;
  if (draw_snap_settings(ui, snap)) out.send(SetSnap{snap});
  draw_last_snap(ui, out);
  if (snap.show_confidence) draw_colouring_legend(ui, Colouring::confidence);
  rule(theme);
}

}  // namespace homolog
