#include "app/editor/update/commands/structure_commands.h"

#include <algorithm>
#include <set>
#include <utility>

#include "app/editor/state/views.h"
#include "app/editor/update/editing.h"
#include "core/case/actions/fields.h"
#include "core/case/placing.h"
#include "core/placement/similarity_fit.h"
#include "core/structures/fitting/set_in_case.h"
#include "core/structures/fitting/shared_in_case.h"
#include "core/structures/naming/level_names.h"

namespace homolog {

void ChooseStructure::spell(Fields& line) {
  line.member("id", id);
}
void ChooseStructure::run(Editing& editing) const {
  EditorState& state = editing.state;
  const Structure* chosen = editing.shown.document().structure(id);
  if (chosen == nullptr) return add_notice(state, "There is no structure \"" + id + "\" in this case.");
  editing.work.snaps.cancel();
  editing.work.contour_fits.cancel();
  state.look.structures.hidden.erase(chosen->id);
  state.look.structures.chosen = {chosen->id};
  state.look.structures.range_from = chosen->id;
  show_structure(state, editing.shown.document(), id);
  if (const auto hover = state.pointer.hover) update_hover(state, editing.controls(), hover->x_px, hover->y_px);
  editing.work.quality.post(editing.shown.displayed(), state.look.structure);
}

void ClickStructure::spell(Fields& line) {
  line.member("id", id);
  line.member("ctrl", ctrl);
  line.member("shift", shift);
}
void ClickStructure::run(Editing& editing) const {
  if (ctrl || shift) return choose_rows(editing.state.look.structures, editing.shown.document(), id, ctrl, shift);
  ChooseStructure{id}.run(editing);
  bring_into_view(editing.state, editing.shown.document());
}

void NextStructure::spell(Fields& line) {
  line.member("back", back);
  line.member("doubtful", doubtful);
}
void NextStructure::run(Editing& editing) const {
  EditorState& state = editing.state;
  const Document& document = editing.shown.document();
  auto listed = listed_structures(state.look.structures, document);
  const Structure* active = editing.structure();
  std::erase_if(listed, [&](const Structure* one) {
    return one != active &&
           (doubtful ? !is_to_be_seen(state.look.structures, *one) : !state.look.structures.shows(one->id));
  });
  const std::size_t count = listed.size();
  const auto at = static_cast<std::size_t>(std::ranges::find(listed, active) - listed.begin());
  const bool alone = count == 0 || (count == 1 && at == 0);
  if (alone && doubtful) return add_notice(state, "No other structure is doubtful.", false);
  if (alone && document.structures.size() > 1)
    return add_notice(state, "The list shows no other structure. Clear the filter, or open an eye.", false);
  if (alone) return add_notice(state, "The case has no other structure. Fit a set to a label map (Structures).", false);
  const std::size_t next = at == count ? (back ? count - 1 : 0) : (at + (back ? count - 1 : 1)) % count;
  ClickStructure{listed[next]->id}.run(editing);
}

void AcceptStructure::run(Editing& editing) const {
  const Structure* active = editing.structure();
  if (active == nullptr) return;
  editing.apply(SetStructure{.id = active->id, .confidence = 1, .doubt = ""});
  const bool more = std::ranges::any_of(editing.shown.document().structures, [&](const auto& one) {
    return one.get() != active && is_to_be_seen(editing.state.look.structures, *one);
  });
  if (more) editing.out.send(NextStructure{false, true});
}

void KeepApart::spell(Fields& line) {
  line.member("gap_mm", gap_mm);
}
void KeepApart::run(Editing& editing) const {
  editing.shown.session().apply_computed(
      [gap_mm = gap_mm](const Document& document, const std::string& of) -> Result<std::optional<Action>> {
        if (auto edit = apart_from_others(document, of, gap_mm)) return std::optional<Action>(std::move(*edit));
        return std::optional<Action>();
      },
      true, editing.state.look.structure);
}

void FollowShared::run(Editing& editing) const {
  const Structure* active = editing.structure();
  const std::set<std::string>& locked = editing.state.look.structures.locked;
  if (active == nullptr || locked.contains(active->id)) return;
  const SharedLead lead{active->id, {locked.begin(), locked.end()}};
  std::vector<std::string> edited = sharing_structures(editing.shown.document(), active->id);
  if (edited.empty()) return;
  edited.insert(edited.begin(), active->id);
  for (std::string& id : edited)
    editing.shown.session().apply_computed(
        [lead](const Document& document, const std::string& of) -> Result<std::optional<Action>> {
          if (auto edit = edit_to_shared(document, of, lead)) return std::optional<Action>(std::move(*edit));
          return std::optional<Action>();
        },
        true, std::move(id));
}

void let_shared_follow(const Document& document, std::string_view of, Outbox& out) {
  if (!sharing_structures(document, of).empty()) out.send(FollowShared{});
}

void TakeBackRepair::run(Editing& editing) const {
  const Structure* active = editing.structure();
  const StructureLooks& looks = editing.state.look.structures;
  if (active == nullptr || !looks.as_read.contains(active->id) || editing.refuses_edits()) return;
  const auto& document = editing.shown.document();
  if (document.frame != looks.as_read_frame || is_taken_back(looks, *active)) return;
  if (const Points* before = shape_as_read(looks, *active)) {
    const Shape shape = shape_of_frame(*active, document.frame, document.frame);
    editing.apply(points_edit({*active, shape, document.frame}, *before, FoundBy::taken_back,
                              nearest_similarity(active->the_template->points, *before, {})));
  } else if (document.structures.size() > 1) {
    editing.apply(RemoveStructure{active->id});
  }
}

void RenameLevels::spell(Fields& line) {
  line.member("steps", steps);
}
void RenameLevels::run(Editing& editing) const {
  const Document& document = *editing.shown.snapshot().document;
  const Structure* active = active_structure(editing.state, document);
  const auto from = active != nullptr ? level_of_name(active->name) : std::nullopt;
  constexpr int most = 24;
  if (!from || steps == 0 || steps < -most || steps > most) return;
  std::vector<std::pair<const Structure*, std::string>> renamed;
  std::set<std::string> kept;
  for (const auto& one : document.structures) {
    const auto level = level_of_name(one->name);
    if (!level || *level < *from) {
      kept.insert(one->name);
      continue;
    }
    std::string name = name_at_level(one->name, *level + steps);
    if (name == one->name)
      return add_notice(editing.state, "There is no such level for \"" + one->name + "\". Nothing was renamed.", false);
    renamed.emplace_back(one.get(), std::move(name));
  }
  for (const auto& [one, name] : renamed)
    if (kept.contains(name))
      return add_notice(editing.state,
                        "\"" + name + "\" is there already, above. Nothing was renamed. Begin at that level.", false);
  bool joined = false;
  for (auto& [one, name] : renamed)
    editing.apply(SetStructure{.id = one->id, .name = name, .label = name}, std::exchange(joined, true));
}

void ShowStructures::spell(Fields& line) {
  line.member("ids", ids);
  line.member("shown", shown);
}
void ShowStructures::run(EditorState& state) const {
  for (const std::string& id : ids)
    if (shown)
      state.look.structures.hidden.erase(id);
    else
      state.look.structures.hidden.insert(id);
}

void ShowOnlyStructures::spell(Fields& line) {
  line.member("ids", ids);
}
void ShowOnlyStructures::run(Editing& editing) const {
  auto& hidden = editing.state.look.structures.hidden;
  hidden.clear();
  for (const auto& one : editing.shown.document().structures)
    if (std::ranges::find(ids, one->id) == ids.end()) hidden.insert(one->id);
}

void LockStructures::spell(Fields& line) {
  line.member("ids", ids);
  line.member("locked", locked);
}
void LockStructures::run(EditorState& state) const {
  for (const std::string& id : ids)
    if (locked)
      state.look.structures.locked.insert(id);
    else
      state.look.structures.locked.erase(id);
}

void SetStructureOpacity::spell(Fields& line) {
  line.member("ids", ids);
  line.member("opacity", opacity);
}
void SetStructureOpacity::run(EditorState& state) const {
  auto& of = state.look.structures.opacity;
  for (const std::string& id : ids)
    if (opacity < 1)
      of[id] = std::max(0.0, opacity);
    else
      of.erase(id);
}

void HideLabels::spell(Fields& line) {
  line.member("labels", labels);
}
void HideLabels::run(EditorState& state) const {
  state.look.hidden_labels =
      labels.empty() ? nullptr : std::make_shared<const std::set<int>>(labels.begin(), labels.end());
}

void cancel_set_fit(Editing& editing) {
  editing.work.set_fitter.cancel();
}

void FilterStructures::spell(Fields& line) {
  line.member("text", text);
}
void FilterStructures::run(Editing& editing) const {
  StructureLooks& looks = editing.state.look.structures;
  looks.filter = text;
  const auto listed = listed_structures(looks, editing.shown.document());
  std::erase_if(looks.chosen, [&](const std::string& id) {
    return std::ranges::none_of(listed, [&](const Structure* one) { return one->id == id; });
  });
}

}  // namespace homolog
