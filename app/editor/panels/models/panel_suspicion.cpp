#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <variant>

#include "app/editor/panels/models/models_panel.h"
#include "app/editor/state/icons.h"
#include "app/editor/widgets/widgets.h"
#include "core/base/numbers/statistics.h"

namespace homolog {

namespace {

constexpr std::size_t most_rows = 6;    ///< of a case; the worst come first
constexpr std::size_t most_cases = 30;  ///< the worst come first

/// One thing to look at, in words.
struct Doubt {
  std::string where, value, tip;
  ImU32 colour = palette::amber;
  std::optional<Eigen::Index> vertex;  ///< its place; none: the whole case
};

/// Why a case is to be looked at. Put into words only where it is shown: a study may have thousands.
using Reason =
    std::variant<const StudyCase*, const SuspiciousShape*, const SuspiciousVertex*, const SuspiciousTriangle*>;

Doubt in_words(const StudyCase& doubtful, const StudyModel&) {
  return {"doubtful fit", "", doubtful.doubt, palette::amber, {}};
}

Doubt in_words(const SuspiciousShape& one, const StudyModel&) {
  const bool far = one.suspicion == Suspicion::far_outside;
  return {"far from the mean",
          format("%.2f mm", one.distance_mm),
          far ? "Very unusual: more than 3 interquartile ranges above the upper quartile (Tukey's outer fence)"
              : "Unusual: more than 1.5 interquartile ranges above the upper quartile (Tukey's fence)",
          far ? palette::bad : palette::amber,
          {}};
}

Doubt in_words(const SuspiciousVertex& one, const StudyModel&) {
  return {format("vertex %td", one.vertex), format("%.2f mm", one.deviation_mm),
          format("Vertex %td lies %.2f mm from where the model of the other shapes expects it. The usual distance is "
                 "%.2f mm.",
                 one.vertex, one.deviation_mm, one.usual_mm),
          palette::amber, one.vertex};
}

Doubt in_words(const SuspiciousTriangle& one, const StudyModel& model) {
  return {format("triangle %td", one.triangle), format("%.2f\xc3\x97", one.stretch),
          format("Triangle %td is stretched or shrunk by a factor of %.2f from the mean shape. The usual factor is "
                 "%.2f.",
                 one.triangle, one.stretch, one.usual),
          palette::amber, model.topology->triangles()(one.triangle, 0)};
}

/// All that is to be looked at in one case.
struct CaseDoubts {
  std::size_t shape = 0;
  bool doubtful_fit = false;
  double weight = 0;      ///< how many times the usual the worst is
  std::size_t count = 0;  ///< of all reasons
  std::vector<Reason> shown;
};

/// One thing to look at; its place is looked at in the gallery, and its case opened there by a double click.
void draw_entry(const UiContext& ui, int id, std::size_t shape, const Doubt& doubt, Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  const std::string& name = state.made.model->names[shape];
  const bool has_place = doubt.vertex.has_value();
  const GalleryVertex place{shape, doubt.vertex.value_or(0)};
  const Part part(format("%d", id), "doubt");
  const ImVec2 at = ImGui::GetCursorScreenPos(), size{ImGui::GetContentRegionAvail().x, theme.px(24)};
  const bool lit = has_place && state.gallery.pinned == place.vertex && state.list.selected == name;
  const auto row = area(theme, "entry", size,
                        doubt.tip + (has_place ? "\nDouble-click opens the case at this place, with the Slide tool."
                                               : "\nDouble-click opens the case."),
                        {lit});
  if (row.clicked) out.send(has_place ? Command(PinVertex{place, true}) : SelectCase{name});
  if (row.doubled) out.send(OpenCaseOfStudy{name, has_place ? std::optional(place.vertex) : std::nullopt});
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  if (row.hovered || lit)
    draw.AddRectFilled({at.x - theme.px(4), at.y}, {at.x + size.x + theme.px(4), at.y + size.y},
                       lit ? with_alpha(palette::accent, 0.25f) : palette::raised, theme.px(4));
  const float y = at.y + std::floor((size.y - ImGui::GetFontSize()) / 2);
  const float value_width = ImGui::CalcTextSize(doubt.value.c_str()).x;
  text_at(draw, {at.x + theme.px(8), y}, palette::text, shortened(doubt.where, size.x - value_width - theme.px(20)));
  text_at(draw, {at.x + size.x - value_width, y}, doubt.colour, doubt.value);
}

/// What is to be looked at, case by case: doubtful fits first, then what exceeds the usual most.
std::vector<CaseDoubts> doubts_by_case(const ModelsState& state) {
  const StudyModel& model = *state.made.model;
  std::map<std::size_t, CaseDoubts> cases;
  const auto add = [&](Eigen::Index shape, const auto& reason, double weight) {
    CaseDoubts& one = cases[shape];
    one.shape = static_cast<std::size_t>(shape);
    one.weight = std::max(one.weight, weight);
    if (one.count++ < most_rows) one.shown.push_back(&reason);
  };
  const CasesByName by_name(state.study);
  for (std::size_t k = 0; k < model.names.size(); ++k) {
    const StudyCase* known = by_name.find(model.names[k]);
    if (known == nullptr || known->doubt.empty() || known->state == CaseState::done) continue;
    add(static_cast<Eigen::Index>(k), *known, 0);
    cases[k].doubtful_fit = true;
  }
  double median_mm = 0;
  if (!model.distances_mm.empty()) median_mm = median_of({model.distances_mm.begin(), model.distances_mm.end()});
  for (const SuspiciousShape& one : model.suspicious_shapes)
    add(one.shape, one, median_mm > 0 ? one.distance_mm / median_mm : 1);
  static const Suspicions none;
  const Suspicions& inside = state.made.suspicions ? *state.made.suspicions : none;
  for (const SuspiciousVertex& one : inside.vertices)
    add(one.shape, one, one.usual_mm > 0 ? one.deviation_mm / one.usual_mm : 1);
  for (const SuspiciousTriangle& one : inside.triangles) add(one.shape, one, one.stretch / one.usual);
  std::vector<CaseDoubts> sorted;
  for (auto& [shape, one] : cases) sorted.push_back(std::move(one));
  std::stable_sort(sorted.begin(), sorted.end(), [](const CaseDoubts& a, const CaseDoubts& b) {
    return std::pair(!a.doubtful_fit, -a.weight) < std::pair(!b.doubtful_fit, -b.weight);
  });
  return sorted;
}

}  // namespace

void draw_suspicion_section(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  if (!state.made.model || state.made.model->names.size() < 4) {
    explanation(theme, "At least four shapes are needed to tell what is unusual.");
    return;
  }
  const std::vector<CaseDoubts> cases = doubts_by_case(state);
  if (!state.made.suspicions) explanation(theme, "Vertices and triangles are still looked at\xe2\x80\xa6");
  if (cases.empty()) {
    if (state.made.suspicions) explanation(theme, "Nothing is unusual.");
    return;
  }
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, 0});
  int id = 0;
  for (std::size_t k = 0; k < std::min(most_cases, cases.size()); ++k) {
    const CaseDoubts& one = cases[k];
    gap(theme, 8);
    const std::string count =
        one.count > most_rows ? format(": the worst %zu of %zu", most_rows, one.count) : std::string();
    const float room = ImGui::GetContentRegionAvail().x - ImGui::CalcTextSize(count.c_str()).x;
    caption(theme,
            (shortened_among(state.made.model->names[one.shape], state.made.model->names, room) + count).c_str());
    for (const Reason& reason : one.shown)
      draw_entry(ui, id++, one.shape,
                 std::visit([&](const auto* why) { return in_words(*why, *state.made.model); }, reason), out);
  }
  if (cases.size() > most_cases) {
    gap(theme, 8);
    caption(theme, format("and %zu more cases", cases.size() - most_cases).c_str());
  }
  ImGui::PopStyleVar();
}

}  // namespace homolog
