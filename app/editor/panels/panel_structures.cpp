#include <algorithm>
#include <cmath>

#include "app/editor/panels/sections.h"
#include "app/editor/panels/ui_context.h"
#include "app/editor/state/icons.h"
#include "app/editor/widgets/widgets.h"
#include "core/structures/naming/level_names.h"

// The list of the case's structures.

namespace homolog {

namespace {

constexpr const char* taken_back_words = "taken back";
constexpr float structure_units = 26, eye_units = 22, most_listed = 9, percent_units = 46;

ImU32 structure_swatch(const Structure& structure) {
  const Rgb colour = structure_colour(structure);
  return ImGui::ColorConvertFloat4ToU32({colour[0], colour[1], colour[2], 1});
}

/// Never rounded up to a certainty.
double whole_percent(double share) {
  constexpr double of_rounding = 1e-6;
  return std::floor(100 * share + of_rounding);
}

std::string vertices_in_words(const Structure& structure, int frame) {
  const Shape* shape = structure.shape(frame);
  if (shape == nullptr) return "No mesh in this frame";
  return format("%d vertices", static_cast<int>(shape->points->rows()));
}

/// How sure it is that a structure is rightly named; below 0: nobody said.
double named_of(const UiContext& ui, const Structure& structure) {
  return name_confidence(ui.snapshot().kept.map_fit.get(), structure);
}

/// All that is known of a structure, for its row's tip.
std::string structure_tip(const UiContext& ui, const Structure& structure) {
  std::string tip = structure_name(structure) + "\n" + vertices_in_words(structure, ui.document().frame);
  if (structure.confidence == 1 && structure.doubt.empty())
    tip += ".\nSomebody looked at it and said that it is right";
  else if (structure.confidence >= 0)
    tip += format(".\nRight: %.0f %%, the probability that its label has the right shape and the right name",
                  whole_percent(structure.confidence));
  if (const double named = named_of(ui, structure); named >= 0 && named < 1)
    tip += format(".\nNamed: %.0f %%, the probability that the name of its label is right", whole_percent(named));
  if (is_taken_back(ui.state.look.structures, structure)) tip += ".\nTaken back: it is as the label map has it";
  if (!structure.doubt.empty()) tip += ".\n" + structure.doubt;
  return tip + "\nClick: work on it. Ctrl or Shift: choose several";
}

/// What lies under a row's text: whether it is worked on, chosen or pointed at.
void draw_structure_ground(const Theme& theme, ImVec2 at, ImVec2 size, bool active, bool chosen, bool hovered) {
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const float alpha = (active ? 0.25f : chosen ? 0.14f : 0.0f) + (hovered ? 0.08f : 0.0f);
  if (alpha > 0)
    draw.AddRectFilled(at, {at.x + size.x, at.y + size.y}, with_alpha(palette::accent, alpha), theme.px(3));
  if (active) draw.AddRectFilled(at, {at.x + theme.px(3), at.y + size.y}, palette::accent, theme.px(1));
}

/// The eye and the lock at the right end of a row.
void draw_eye_and_lock(const UiContext& ui, const Structure& structure, ImVec2 at, float width, Outbox& out) {
  const Theme& theme = ui.theme;
  const StructureLooks& looks = ui.state.look.structures;
  const float side = theme.px(eye_units), y = at.y + std::floor((theme.px(structure_units) - side) / 2);
  const auto rows = rows_with(looks, structure.id);
  const bool several = rows.size() > 1;
  const bool shown = looks.shows(structure.id), locked = looks.locks(structure.id);
  ImGui::SetCursorScreenPos({at.x + width - 2 * side, y});
  if (icon_button(
          theme, shown ? icon::eye : icon::eye_shut, "eye",
          std::string(shown ? "Hides " : "Shows ") + (several ? "the chosen structures" : "it") + " in all views", {},
          false, eye_units))
    out.send(ShowStructures{rows, !shown});
  ImGui::SetCursorScreenPos({at.x + width - side, y});
  if (icon_button(theme, locked ? icon::confirm : icon::unlocked, "lock",
                  locked ? (several ? "Unlocks the chosen structures" : "Unlocks it: it can be edited again")
                         : (several ? "Locks the chosen structures against edits" : "Locks it: edits are refused"),
                  {}, locked, eye_units))
    out.send(LockStructures{rows, !locked});
}

/// `named_known`: a column says how sure each name is.
void draw_structure(const UiContext& ui, const Structure& structure, float width, bool named_known, Outbox& out) {
  const Theme& theme = ui.theme;
  const StructureLooks& looks = ui.state.look.structures;
  const Part part(structure_name(structure), "structure");
  const ImVec2 at = ImGui::GetCursorScreenPos(), size{width, theme.px(structure_units)};
  const bool active = &structure == ui.structure(), shown = looks.shows(structure.id);
  const ImGuiIO& io = ImGui::GetIO();
  ImGui::PushID(structure.id.c_str());
  const ImVec2 named_px{width - theme.px(2 * eye_units), size.y};
  const AreaState row = area(theme, structure_name(structure), named_px, structure_tip(ui, structure), {active});
  if (row.clicked) out.send(ClickStructure{structure.id, io.KeyCtrl, io.KeyShift});
  draw_structure_ground(theme, at, size, active, looks.chosen.contains(structure.id), row.hovered);
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const float swatch = theme.px(12), text_y = std::floor(at.y + (size.y - ImGui::GetFontSize()) / 2);
  colour_swatch(draw, theme, {at.x + theme.px(8), std::floor(at.y + (size.y - swatch) / 2)}, swatch,
                structure_swatch(structure));
  const float right = at.x + width - theme.px(2 * eye_units + 6), left = at.x + theme.px(28);
  const auto percent_at = [&](float ends_at, double share, bool doubtful) {
    const EvenDigits digits(theme);
    const std::string sure = format("%.0f %%", whole_percent(share));
    text_at(draw, {ends_at - ImGui::CalcTextSize(sure.c_str()).x, text_y}, doubtful ? palette::amber : palette::dim,
            sure);
  };
  float room = right - left - theme.px(percent_units);
  // What the repair thought of it counts no more.
  const bool taken_back = is_doubtful(structure) && is_taken_back(looks, structure);
  if (taken_back) {
    const float words_px = ImGui::CalcTextSize(taken_back_words).x;
    text_at(draw, {right - words_px, text_y}, palette::dim, taken_back_words);
    room = right - left - words_px - theme.px(8);
  } else if (structure.confidence >= 0) {
    percent_at(right, structure.confidence, is_doubtful(structure));
  }
  if (named_known && !taken_back) {
    constexpr double sure = 0.5;
    const double named = named_of(ui, structure);
    if (named >= 0) percent_at(right - theme.px(percent_units), named, named < sure);
    room -= theme.px(percent_units);
  }
  text_at(draw, {left, text_y}, shown ? palette::text : palette::faint, shortened(structure_name(structure), room));
  draw_eye_and_lock(ui, structure, at, width, out);
  ImGui::SetCursorScreenPos({at.x, at.y + size.y});
  ImGui::PopID();
}

/// Scrolls the list to the row of the structure that is worked on, when it has become another one.
void follow_active(const UiContext& ui, const std::vector<const Structure*>& listed) {
  const auto row = std::ranges::find(listed, ui.structure());
  if (row == listed.end()) return;
  ImGuiStorage& storage = *ImGui::GetStateStorage();
  const ImGuiID key = ImGui::GetID("worked on");
  const auto now = static_cast<int>(ImGui::GetID((*row)->id.c_str()));
  if (storage.GetInt(key) == now) return;
  storage.SetInt(key, now);
  const float height = ui.theme.px(structure_units), top = static_cast<float>(row - listed.begin()) * height;
  const float least = top + height - ImGui::GetWindowHeight();
  ImGui::SetScrollY(std::clamp(ImGui::GetScrollY(), std::min(least, top), top));
}

void draw_structure_filter(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const float width = ImGui::GetContentRegionAvail().x, sort_width = theme.px(96);
  std::string filter = ui.state.look.structures.filter;
  if (text_field(theme, "filter", filter, "Filter by name", width - sort_width - theme.px(4)))
    out.send(FilterStructures{filter});
  ImGui::SameLine(0, theme.px(4));
  const bool worst = ui.state.look.structures.worst_first;
  if (button(theme, worst ? "Worst first" : "By label",
             worst ? "The least sure structure is on top. Click for the order of the case"
                   : "The order of the case. Click to have the least sure structure on top",
             {}, sort_width))
    out.send(SortStructures{!worst});
}

void draw_eyes(const UiContext& ui, const std::vector<const Structure*>& listed, Outbox& out) {
  const Theme& theme = ui.theme;
  const float third = (ImGui::GetContentRegionAvail().x - 2 * theme.px(4)) / 3;
  std::vector<std::string> ids;
  for (const Structure* one : listed) ids.push_back(one->id);
  const std::string none_listed = listed.empty() ? "No name holds what you typed." : "";
  if (button(theme, "Show all", "Opens the eyes of all structures in the list", none_listed, third))
    out.send(ShowStructures{ids, true});
  ImGui::SameLine(0, theme.px(4));
  if (button(theme, "Show none", "Shuts the eyes of all structures in the list", none_listed, third))
    out.send(ShowStructures{ids, false});
  ImGui::SameLine(0, theme.px(4));
  const Structure* active = ui.structure();
  if (button(theme, "Only this", "Shows the structure that you work on (or all that are chosen) and hides the others",
             active == nullptr ? "There is no structure." : "", third))
    out.send(ShowOnlyStructures{rows_with(ui.state.look.structures, active->id)});
}

/// What the numbers of the list are.
void draw_list_head(const UiContext& ui, float width, bool named_known) {
  const Theme& theme = ui.theme;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  ImGui::PushFont(theme.small);
  const auto ends = [&](float x, const char* words) {
    text_at(draw, {x - ImGui::CalcTextSize(words).x, at.y}, palette::faint, words);
  };
  const float right = at.x + width - theme.px(2 * eye_units + 6);
  ends(right, "right");
  if (named_known) ends(right - theme.px(percent_units), "named");
  ImGui::Dummy({width, ImGui::GetFontSize() + theme.px(2)});
  ImGui::PopFont();
}

void draw_own_opacity(const UiContext& ui, Outbox& out) {
  const Structure* active = ui.structure();
  if (active == nullptr) return;
  double opacity = 100 * ui.state.look.structures.opacity_of(active->id);
  bool released = false;
  if (slider(ui.theme, "Opacity", opacity, {0, 100, "%.0f", "%", false},
             "Opacity in 3D of the structure that you work on, or of all that are chosen. The case keeps it", released))
    out.send(SetStructureOpacity{rows_with(ui.state.look.structures, active->id), opacity / 100});
}

void draw_others_opacity(const UiContext& ui, Outbox& out) {
  double opacity = 100 * ui.state.look.structures.others_opacity;
  bool released = false;
  if (slider(
          ui.theme, "Others", opacity, {0, 100, "%.0f", "%", false},
          "Opacity in 3D of the structures that you do not work on. At 0 only the one that you work on is drawn there",
          released))
    out.send(SetOthersOpacity{opacity / 100});
}

void draw_gap(const UiContext& ui, Outbox& out) {
  double gap_mm = ui.state.automatic.gap_mm;
  bool released = false;
  if (slider(ui.theme, "Gap", gap_mm, {0, 5, "%.1f", "mm", false},
             "What Keep apart and Fit the set leave between neighbours, as cartilage does", released))
    out.send(SetStructureGap{gap_mm});
}

/// The way to the next doubtful one, and a person's word that one is right.
void draw_judging(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const float half = (ImGui::GetContentRegionAvail().x - theme.px(4)) / 2;
  const Structure* active = ui.structure();
  const auto& all = ui.document().structures;
  const bool other = std::ranges::any_of(
      all, [&](const auto& one) { return one.get() != active && is_to_be_seen(ui.state.look.structures, *one); });
  if (button(theme, "Next doubtful", "Works on the next structure that has to be looked at (K)",
             other ? "" : "No other structure is doubtful.", half))
    out.send(NextStructure{false, true});
  ImGui::SameLine(0, theme.px(4));
  if (button(theme, "It is right",
             "You have looked at this structure: its confidence becomes 100 %. Goes on to the next doubtful one. One "
             "step to undo",
             active == nullptr                                  ? "There is no structure."
             : active->confidence == 1 && active->doubt.empty() ? "You said so already."
                                                                : "",
             half))
    out.send(AcceptStructure{});
}

/// What a repair changed of the structure that is worked on, and the way back.
void draw_repair(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const StructureLooks& looks = ui.state.look.structures;
  const Structure* active = ui.structure();
  if (active == nullptr || looks.as_read.empty()) return;
  const bool taken_back = is_taken_back(looks, *active);
  if (taken_back)
    explanation(theme, "Taken back: it is as the label map has it.");
  else if (!active->doubt.empty())
    explanation(theme, active->doubt.c_str());
  const bool changed = looks.as_read.contains(active->id), missing = changed && !looks.as_read.at(active->id);
  const float half = (ImGui::GetContentRegionAvail().x - theme.px(4)) / 2;
  const bool shown = looks.as_read_shown;
  if (button(theme, shown ? "Hide as read" : "Show as read",
             "Shows repaired structures also as the label map has them, in white (H)", {}, half))
    out.send(ShowAsRead{!shown});
  ImGui::SameLine(0, theme.px(4));
  if (button(theme, "Take back",
             missing ? "The label map has no such structure, and it goes again. One step to undo"
                     : "Takes the proposal back: the structure is as the label map has it. One step to undo",
             !changed     ? "The repair did not change this structure."
             : taken_back ? "It was taken back."
             : ui.document().frame != looks.as_read_frame
                 ? format("Another frame was repaired: %d.", looks.as_read_frame)
                 : std::string(),
             half))
    out.send(TakeBackRepair{});
}

/// Other names for a spine whose levels were counted wrongly.
void draw_levels(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const Structure* active = ui.structure();
  if (active == nullptr || !level_of_name(active->name)) return;
  caption(theme, "Names of this level and all below");
  const float half = (ImGui::GetContentRegionAvail().x - theme.px(4)) / 2;
  if (button(theme, "One level up", "L3 becomes L2, L4 becomes L3 and so on. One step to undo", {}, half))
    out.send(RenameLevels{-1});
  ImGui::SameLine(0, theme.px(4));
  if (button(theme, "One level down", "L3 becomes L4, L4 becomes L5 and so on. One step to undo", {}, half))
    out.send(RenameLevels{1});
}

}  // namespace

std::string structures_in_words(const UiContext& ui) {
  const std::size_t count = ui.document().structures.size();
  const Structure* active = ui.structure();
  return count > 1 && active != nullptr ? format("%zu, ", count) + structure_name(*active) : std::string();
}

void draw_structures_section(const UiContext& ui, Outbox& out) {
  const Theme& theme = ui.theme;
  const auto& document = ui.document();
  if (document.structures.size() < 2) {
    draw_labels(ui, out);
    draw_set_fit(ui, out);
    return draw_gap(ui, out);
  }
  const auto listed = listed_structures(ui.state.look.structures, document);
  draw_structure_filter(ui, out);
  const float rows = std::clamp(static_cast<float>(document.structures.size()), 2.0f, most_listed);
  const bool judged = std::ranges::any_of(listed, [](const Structure* one) { return one->confidence >= 0; });
  const bool named_known =
      ui.snapshot().kept.map_fit && std::ranges::any_of(listed, [&](auto* one) { return named_of(ui, *one) >= 0; });
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, 0});
  if (judged) draw_list_head(ui, ImGui::GetContentRegionAvail().x, named_known);
  ImGui::BeginChild("structures", {0, std::floor(rows * theme.px(structure_units))});
  const float width = ImGui::GetContentRegionAvail().x;
  follow_active(ui, listed);
  for (const Structure* one : listed) draw_structure(ui, *one, width, named_known, out);
  if (listed.empty()) explanation(theme, "No name holds what you typed.");
  ImGui::EndChild();
  ImGui::PopStyleVar();
  draw_eyes(ui, listed, out);
  draw_own_opacity(ui, out);
  draw_others_opacity(ui, out);
  draw_judging(ui, out);
  draw_repair(ui, out);
  draw_levels(ui, out);
  bool apart = ui.state.automatic.keep_apart;
  if (toggle(theme, "Keep apart", apart,
             "At the end of a pull or a grab the structure goes out of its neighbours, where they lie within each "
             "other. One step to undo with the gesture"))
    out.send(KeepApartAfterStrokes{apart});
  draw_gap(ui, out);
  if (ui.labels().volume || ui.work.set_fitter.busy()) draw_set_fit(ui, out);
}

}  // namespace homolog
