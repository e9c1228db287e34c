#include <algorithm>
#include <cmath>

#include "app/editor/panels/models_ui.h"
#include "app/editor/widgets/icons.h"
#include "app/editor/widgets/widgets.h"

namespace homolog {

namespace {

constexpr std::size_t most_rows = 30;  ///< of a kind; the worst come first

/// One thing to look at; its place is looked at in the gallery, and its case opened there by a double click.
/// `where`: after the case's name.
void draw_entry(const UiContext& ui, int id, const GalleryVertex& place, const std::string& where,
                const std::string& value, const std::string& tip, ImU32 colour, bool has_place, Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  const std::string& name = state.model->names[place.shape];
  const Part part(format("%d", id), "doubt");
  const ImVec2 at = ImGui::GetCursorScreenPos(), size{ImGui::GetContentRegionAvail().x, theme.px(24)};
  const bool lit = has_place && state.pinned == place.vertex && state.selected == name;
  const auto row =
      area(theme, "entry", size, tip + "\nDouble-click opens the case at this place, with the Slide tool.", {lit});
  if (row.clicked) out.send(has_place ? Command(PinVertex{place, true}) : SelectCase{name});
  if (row.doubled) out.send(OpenCaseOfStudy{name, has_place ? std::optional(place.vertex) : std::nullopt});
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  if (row.hovered || lit)
    draw.AddRectFilled({at.x - theme.px(4), at.y}, {at.x + size.x + theme.px(4), at.y + size.y},
                       lit ? with_alpha(palette::accent, 0.25f) : palette::raised, theme.px(4));
  const float y = at.y + std::floor((size.y - ImGui::GetFontSize()) / 2);
  const float value_width = ImGui::CalcTextSize(value.c_str()).x;
  const float name_room = size.x - value_width - theme.px(12) - ImGui::CalcTextSize(where.c_str()).x;
  text_at(draw, {at.x, y}, palette::text, shortened_among(name, state.model->names, name_room) + where);
  text_at(draw, {at.x + size.x - value_width, y}, colour, value);
}

/// "Stretched or shrunk triangles: 4", and how many are not listed.
void draw_caption(const Theme& theme, const char* what, std::size_t count) {
  gap(theme, 8);
  caption(theme, count > most_rows ? format("%s: the worst %zu of %zu", what, most_rows, count).c_str()
                                   : format("%s: %zu", what, count).c_str());
}

}  // namespace

void draw_suspicion_section(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  if (!state.model || state.model->names.size() < 4) {
    explanation(theme, "At least four shapes are needed to tell what is unusual.");
    return;
  }
  const StudyModel& model = *state.model;
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, 0});
  int id = 0;
  draw_caption(theme, "Cases far from the mean", model.suspicious_shapes.size());
  for (const SuspiciousShape& one : model.suspicious_shapes)
    draw_entry(ui, id++, {static_cast<std::size_t>(one.shape), 0}, "", format("%.2f mm", one.distance_mm),
               one.suspicion == Suspicion::far_outside
                   ? "Very unusual: more than 3 interquartile ranges above the upper quartile (Tukey's outer fence)"
                   : "Unusual: more than 1.5 interquartile ranges above the upper quartile (Tukey's fence)",
               one.suspicion == Suspicion::far_outside ? palette::bad : palette::amber, false, out);
  draw_caption(theme, "Vertices in unexpected places", model.suspicious_vertices.size());
  for (std::size_t k = 0; k < std::min(most_rows, model.suspicious_vertices.size()); ++k) {
    const SuspiciousVertex& one = model.suspicious_vertices[k];
    draw_entry(ui, id++, {static_cast<std::size_t>(one.shape), one.vertex}, format(", %td", one.vertex),
               format("%.2f mm", one.deviation_mm),
               format("Vertex %td lies %.2f mm from where the model of the other shapes expects it. The usual distance "
                      "is %.2f mm.",
                      one.vertex, one.deviation_mm, one.usual_mm),
               palette::amber, true, out);
  }
  draw_caption(theme, "Stretched or shrunk triangles", model.suspicious_triangles.size());
  for (std::size_t k = 0; k < std::min(most_rows, model.suspicious_triangles.size()); ++k) {
    const SuspiciousTriangle& one = model.suspicious_triangles[k];
    const Eigen::Index corner = model.topology->triangles()(one.triangle, 0);
    draw_entry(
        ui, id++, {static_cast<std::size_t>(one.shape), corner}, format(", triangle %td", one.triangle),
        format("%.2f\xc3\x97", one.stretch),
        format("Triangle %td is stretched or shrunk by a factor of %.2f from the mean shape. The usual factor is %.2f.",
               one.triangle, one.stretch, one.usual),
        palette::amber, true, out);
  }
  ImGui::PopStyleVar();
}

}  // namespace homolog
