#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>

#include "app/editor/panels/models/models_panel.h"
#include "app/editor/widgets/widgets.h"

// The sections Sizes and Observers of the Models mode: what is measured of every case, as tables.

namespace homolog {

namespace {

/// A table in the panel: a name and up to three figures a row.
struct FigureTable {
  const Theme& theme;
  float width = ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ScrollbarSize;
  static constexpr float figure_units = 58;

  float right(std::size_t column, std::size_t columns) const {
    return width - static_cast<float>(columns - 1 - column) * theme.px(figure_units);
  }
  /// The texts of a row at `at`; `names` are those of all rows.
  void put(ImVec2 at, const std::string& name, const std::array<std::string, 3>& figures, ImU32 colour,
           const std::vector<std::string>& names = {}) const {
    ImDrawList& draw = *ImGui::GetWindowDrawList();
    text_at(draw, at, colour, shortened_among(name, names, right(0, 3) - theme.px(figure_units) - theme.px(4)));
    const EvenDigits digits(theme);
    for (std::size_t k = 0; k < figures.size(); ++k)
      text_at(draw, {at.x + right(k, 3) - text_size(ImGui::GetFont(), figures[k]).x, at.y}, colour, figures[k]);
  }
  /// A row that says something of all.
  void line(const std::string& name, const std::array<std::string, 3>& figures, ImU32 colour = palette::dim) const {
    put(ImGui::GetCursorScreenPos(), name, figures, colour);
    ImGui::Dummy({width, theme.px(20)});
  }
};

/// Rows of cases, each of which a click selects; beyond some they scroll.
template <class Row>
void draw_rows(const UiContext& ui, const FigureTable& table, const std::vector<std::string>& names, const Row& row,
               Outbox& out) {
  const Theme& theme = ui.theme;
  constexpr std::size_t most = 12;
  const float height = theme.px(22);
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, 0});
  ImGui::BeginChild("rows", {0, height * static_cast<float>(std::min(names.size(), most))});
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(names.size()), height);
  while (clipper.Step())
    for (int k = clipper.DisplayStart; k < clipper.DisplayEnd; ++k) {
      const std::string& title = names[k];
      const std::array<std::string, 3> figures = row(static_cast<std::size_t>(k));
      const Part part(title, "case");
      const ImVec2 at = ImGui::GetCursorScreenPos();
      const bool selected = ui.state.models.list.selected == title;
      const AreaState state = area(theme, "sizes", {table.width, height}, title, {selected});
      if (state.clicked) out.send(SelectCase{title});
      if (selected || state.hovered)
        ImGui::GetWindowDrawList()->AddRectFilled(at, {at.x + table.width, at.y + height},
                                                  selected ? with_alpha(palette::accent, 0.25f) : palette::raised,
                                                  theme.px(3));
      table.put({at.x, at.y + std::floor((height - ImGui::GetFontSize()) / 2)}, title, figures, palette::text, names);
    }
  ImGui::EndChild();
  ImGui::PopStyleVar();
}

std::string or_dash(const std::optional<double>& value, const char* pattern) {
  char text[40];
  std::snprintf(text, sizeof text, pattern, value.value_or(0));
  return value ? text : "\xe2\x80\x93";
}

/// The figures of one shape: ml, cm², mm.
/// The window shows an open ventricle's volume too, as its curve does: the base counts as closed flat.
std::optional<double> shown_volume_ml(const ShapeSizes& sizes) {
  return sizes.volume_ml ? sizes.volume_ml : sizes.volume_capped_ml;
}

std::array<std::string, 3> figures_of(const ShapeSizes& sizes, const std::optional<LandmarkPair>& pair) {
  auto area_cm2 = sizes.area_mm2;
  if (area_cm2) *area_cm2 /= 100;
  return {or_dash(shown_volume_ml(sizes), "%.1f"), or_dash(area_cm2, "%.1f"),
          pair ? or_dash(distance_mm(sizes, *pair), "%.1f") : ""};
}

/// Mean and standard deviation over all, as rows.
void draw_spreads(const FigureTable& table, const std::vector<ShapeSizes>& sizes,
                  const std::optional<LandmarkPair>& pair) {
  std::array<std::vector<std::optional<double>>, 3> values;
  for (const ShapeSizes& one : sizes) {
    values[0].push_back(shown_volume_ml(one));
    values[1].push_back(one.area_mm2 ? std::optional(*one.area_mm2 / 100) : std::nullopt);
    values[2].push_back(pair ? distance_mm(one, *pair) : std::nullopt);
  }
  std::array<std::string, 3> means, deviations;
  for (std::size_t k = 0; k < 3; ++k) {
    const Spread spread = spread_of(values[k]);
    means[k] = spread.count > 0 ? format("%.1f", spread.mean) : "";
    deviations[k] = spread.count > 1 ? format("%.1f", spread.sd) : "";
  }
  rule(table.theme);
  table.line("Mean", means);
  table.line("SD", deviations);
}

}  // namespace

void draw_sizes_section(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const ListedSizes listed = listed_sizes(ui.state.models);
  if (listed.sizes.empty()) return explanation(theme, "Volume, area and distances of the study's cases.");
  const auto pairs = landmark_pairs(listed.sizes);
  std::optional<LandmarkPair> pair;
  if (!pairs.empty()) {
    std::vector<std::string> names;
    for (const auto& [from, to] : pairs) names.push_back(from + " to " + to);
    int chosen = static_cast<int>(std::min(ui.state.models.list.distance_shown, pairs.size() - 1));
    if (combo(theme, "distance", names, chosen)) out.send(ShowDistance{static_cast<std::size_t>(chosen)});
    pair = pairs[chosen];
  } else {
    explanation(theme, "Name landmarks in the template to see distances.");
  }
  const FigureTable table{theme};
  table.line("Case", {"ml", "cm\xc2\xb2", pair ? "mm" : ""});
  draw_rows(
      ui, table, listed.names, [&](std::size_t k) { return figures_of(listed.sizes[k], pair); }, out);
  draw_spreads(table, listed.sizes, pair);
  if (std::ranges::any_of(listed.sizes, [](const ShapeSizes& one) { return one.volume_capped_ml.has_value(); }))
    explanation(theme, "Openings count as closed flat.");
  const float half = std::floor((ImGui::GetContentRegionAvail().x - theme.px(8)) / 2);
  if (button(theme, "Table\xe2\x80\xa6",
             "Volume, area and every distance between landmarks: .csv" + of_optimised(ui.state.models), {}, half))
    out.send(ShowFileDialog{FilePurpose::export_sizes, study_stem(ui.state.models) + "-sizes.csv"});
  ImGui::SameLine(0, theme.px(8));
  if (button(theme, "Landmarks\xe2\x80\xa6",
             "The landmarks of all cases: .tps for geomorph, .csv for MorphoJ" + of_optimised(ui.state.models),
             pairs.empty() ? "No case has two named landmarks." : "", half))
    out.send(ShowFileDialog{FilePurpose::export_landmark_table, study_stem(ui.state.models) + "-landmarks.tps"});
}

namespace {

/// With its sign; no sign of nothing.
std::string difference_ml(double difference) {
  const std::string text = format("%+.1f", difference);
  return text == "-0.0" || text == "+0.0" ? "0.0" : text;
}

void draw_agreement(const UiContext& ui, const ObserverComparison& comparison, Outbox& out) {
  const Theme& theme = ui.theme;
  const FigureTable table{theme};
  table.line("Case", {"Dice", "mm", "\xce\x94 ml"});
  const auto row = [&](std::size_t k) {
    const ObservedCase& one = comparison.cases[k];
    return std::array{format("%.3f", one.agreement.dice), format("%.2f", one.agreement.assd_mm),
                      difference_ml(one.volume_b_ml - one.volume_a_ml)};
  };
  std::vector<std::string> names;
  for (const ObservedCase& one : comparison.cases) names.push_back(one.name);
  draw_rows(ui, table, names, row, out);
  const auto over = [&](const auto& value_of) {
    std::vector<std::optional<double>> values;
    for (const ObservedCase& one : comparison.cases) values.push_back(value_of(one));
    return spread_of(values);
  };
  const std::array spreads{
      over([](const ObservedCase& one) { return std::optional(one.agreement.dice); }),
      over([](const ObservedCase& one) { return std::optional(one.agreement.assd_mm); }),
      over([](const ObservedCase& one) { return std::optional(one.volume_b_ml - one.volume_a_ml); })};
  rule(theme);
  table.line("Mean",
             {format("%.3f", spreads[0].mean), format("%.2f", spreads[1].mean), difference_ml(spreads[2].mean)});
  if (comparison.cases.size() > 1)
    table.line("SD", {format("%.3f", spreads[0].sd), format("%.2f", spreads[1].sd), format("%.1f", spreads[2].sd)});
  explanation(theme, "mm: mean distance of the surfaces. \xce\x94 ml: the other observer's volume minus this one.");
  std::map<std::string, std::vector<std::optional<double>>> landmarks;
  for (const ObservedCase& one : comparison.cases)
    for (const auto& [name, distance] : one.landmarks_mm) landmarks[name].emplace_back(distance);
  if (!landmarks.empty()) caption(theme, "Distance of the landmarks");
  for (const auto& [name, distances] : landmarks) {
    const Spread spread = spread_of(distances);
    figure(theme, name.c_str(), format("%.2f \xc2\xb1 %.2f mm", spread.mean, spread.sd),
           "Mean distance between the two observers' places, \xc2\xb1 standard deviation");
  }
  if (const std::size_t alone = comparison.only_first.size() + comparison.only_second.size(); alone > 0)
    explanation(theme, format("%zu %s in only one of the studies.", alone, alone == 1 ? "case is" : "cases are"));
}

}  // namespace

void draw_observers_section(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const ModelsState& state = ui.state.models;
  const float width = ImGui::GetContentRegionAvail().x;
  if (state.observer.comparison) {
    figure(theme, "With", state.observer.study.filename().string(), state.observer.study.string());
    draw_agreement(ui, *state.observer.comparison, out);
    if (button(theme, "Table\xe2\x80\xa6", "Every case with Dice, distances, volumes and landmarks: .csv", {}, width))
      out.send(ShowFileDialog{FilePurpose::export_observers, study_stem(state) + "-observers.csv"});
  } else if (state.observer.outdated && !ui.comparing()) {
    explanation(theme, "Shapes have changed since they were compared.");
    if (button(theme, "Compare again", "With " + state.observer.study.string(),
               ButtonOptions{.width_px = width, .primary = true}))
      out.send(CompareObservers{{state.observer.study}});
  } else {
    explanation(theme, "Two observers of the same cases: Dice, distances of surfaces and landmarks, volumes.");
  }
  if (button(theme, "Compare with a study\xe2\x80\xa6",
             "Choose the study of the other observer. Its cases must have the same names",
             ui.comparing()               ? "A comparison is running."
             : state.shapes.shown.empty() ? "This study has no shape yet."
                                          : "",
             width))
    out.send(ShowFileDialog{FilePurpose::open_observer, {}});
  std::optional<WorkShown> running;
  if (ui.comparing()) running = {"Comparing", *ui.comparing(), "Nothing is compared"};
  if (work_area(theme, "", running)) out.send(CancelObservers{});
}

}  // namespace homolog
