#include "app/editor/update/results/set_fit.h"

#include <algorithm>
#include <utility>

#include "app/editor/update/editing.h"
#include "app/editor/update/results/results.h"
#include "core/base/text/text.h"
#include "core/case/moved_points.h"
#include "core/structures/fitting/set_in_case.h"
#include "core/structures/naming/level_names.h"
#include "core/volume/labels/segmentation.h"

namespace homolog {

namespace {

/// Whether a step works on one of these structures.
bool is_of(const EditStep& step, const std::set<std::string>& ids) {
  if (const auto* set = std::get_if<SetStructure>(&step.action)) return ids.contains(set->id);
  if (const auto* gone = std::get_if<RemoveStructure>(&step.action)) return ids.contains(gone->id);
  return ids.contains(step.of);
}

std::string count_of(std::size_t count, const char* what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

void say_fitted(EditorState& state, const SetFitted& found, std::size_t locked) {
  std::size_t fitted = 0, doubtful = 0;
  std::string failed;
  for (std::size_t k = 0; k < found.fitted.structures.size(); ++k) {
    const FittedStructure& one = found.fitted.structures[k];
    fitted += one.fit ? 1 : 0;
    doubtful += one.fit && one.judgement.doubtful ? 1 : 0;
    if (!one.why_not.empty()) failed += (failed.empty() ? "" : ", ") + found.set->set.structures[k].name;
  }
  std::string said = count_of(fitted, "structure") + " fitted";
  if (!found.found.empty()) {
    const auto wrong = std::ranges::count_if(found.found, [](const auto& one) { return !one.empty(); });
    said += wrong == 0 ? "; nothing wrong was found."
                       : "; something was found in " + std::to_string(wrong) + ", on top of the list.";
  } else {
    said +=
        doubtful == 0 ? "; none is doubtful." : "; " + std::to_string(doubtful) + " to look at, on top of the list.";
  }
  if (locked > 0)
    said += " " + count_of(locked, "locked one") + (locked == 1 ? " stayed as it was." : " stayed as they were.");
  if (!failed.empty()) said += " Not fitted: " + failed + ".";
  add_notice(state, std::move(said), false);
}

std::vector<double> rounded_coordinates(const Points& points) {
  std::vector<double> rounded;
  for (Eigen::Index v = 0; v < points.rows(); ++v)
    for (Eigen::Index axis = 0; axis < 3; ++axis) rounded.push_back(on_grid(points(v, axis)));
  return rounded;
}

/// What the structures that the steps bring are in the label map, and what its repair found. Of locked ones stays what
/// was known `before`.
KeptMapFit fit_to_keep(const SetFitted& found, const std::vector<EditStep>& steps, int frame, const KeptMapFit* before,
                       const std::set<std::string>& locked) {
  const auto& structures = found.set->set.structures;
  KeptMapFit fit = map_fit_of(found.set->set, found.subject, found.fitted, steps, frame);
  fit.changes = found.changes;
  for (auto& [id, in] : fit.structures) {
    const auto k =
        static_cast<std::size_t>(std::ranges::find(structures, in.name, &TemplateOfSet::name) - structures.begin());
    if (found.found.empty() || found.found[k].empty()) continue;
    const auto& as_read = found.as_read[k];
    in.was_missing = !as_read.has_value();
    if (as_read && *as_read != found.fitted.structures[k].fit->mesh.points) in.as_read = rounded_coordinates(*as_read);
  }
  if (before != nullptr)
    for (const auto& [id, in] : before->structures)
      if (locked.contains(id)) fit.structures.emplace(id, in);
  return fit;
}

void take_set_fit(Editing& editing, const SetFitted& found) {
  EditorState& state = editing.state;
  const Document& document = *editing.shown.snapshot().document;
  auto steps = steps_of_fitted_set(document, *found.set, found.subject, found.fitted, found.found);
  for (const EditStep& step : steps)
    if (const auto* set = std::get_if<SetStructure>(&step.action);
        set != nullptr && document.structure(set->id) == nullptr)
      begin_looks(state.look.structures, set->id);
  std::size_t locked = 0;
  std::erase_if(steps, [&](const EditStep& step) {
    const auto* described = std::get_if<SetStructure>(&step.action);
    const bool is_relation = described != nullptr && !described->name;  // which changes no mesh
    const bool stays = is_of(step, state.look.structures.locked) && !is_relation;
    locked += stays && described != nullptr && described->name ? 1 : 0;
    return stays;
  });
  const auto fit = std::make_shared<const KeptMapFit>(fit_to_keep(
      found, steps, document.frame, editing.shown.snapshot().kept.map_fit.get(), state.look.structures.locked));
  take_as_read(state.look.structures, *fit);
  bool joined = false;
  for (EditStep& step : steps)
    editing.shown.session().apply(std::move(step.action), std::exchange(joined, true), std::move(step.of));
  editing.shown.session().apply(Note{"fit of the set", {}, {}, {}, {}, fit}, true);
  for (const std::string& warning : found.warnings) add_notice(state, warning, false);
  say_fitted(state, found, locked);
  state.look.making_shown = false;
  editing.work.set_enters = true;
  editing.log.is_done(FitSet{!found.found.empty()});
}

}  // namespace

void choose_set(Editing& editing, const std::string& source) {
  editing.work.imports.queue(source, [source](Progress&) -> Result<Work::Then> {
    auto read = load_set_of_templates(source);
    if (!read) return fail(read.error());
    const auto set = std::make_shared<const SetOfTemplates>(std::move(*read));
    return Work::Then([source, set](Editing& then) {
      then.state.automatic.set_source = source;
      then.state.automatic.set = set;
      for (const std::string& warning : set->warnings) add_notice(then.state, warning, false);
      then.log.is_done(ChooseSet{source});
    });
  });
}

std::string set_fit_refusal(const EditorState& state, const ShownCase& shown, const Work& work) {
  if (work.set_fitter.busy()) return "The set is being fitted.";
  if (!shown.labels().volume) return "Open a label map first.";
  if (!state.automatic.set) return "Choose a template set first.";
  if (shown.labels().file.empty()) return "This label map is no file. Save it, and open it again.";
  if (names_in_map(state.automatic.set->set, shown.labels()).empty())
    return "The label map has no label of this set. Choose another set, or rename the labels.";
  if (state.look.playing) return "Stop the cine first.";
  return shown.labels().refusal_at(shown.document().frame);
}

void start_set_fit(Editing& editing, bool repair) {
  if (const std::string why = set_fit_refusal(editing.state, editing.shown, editing.work); !why.empty())
    return add_notice(editing.state, why, false);
  const Document& document = editing.shown.document();
  const std::filesystem::path& labels = editing.shown.labels().file;
  // A label map that was opened by itself is shown as an image, and shows no boundary but its own.
  const bool is_scan = std::filesystem::path(document.scan.source) != labels;
  editing.work.set_fitter.start(
      editing.state.automatic.set,
      {labels, document.frame, is_scan ? document.scan.image : nullptr, editing.state.automatic.gap_mm}, repair,
      editing.shown.number());
}

bool update_set_fit(Editing& editing) {
  SetFitter& fitter = editing.work.set_fitter;
  const bool of_this =
      fitter.case_number() == editing.shown.number() && fitter.frame() == editing.shown.snapshot().document->frame;
  if (fitter.busy() && !of_this) {
    fitter.cancel();
    add_notice(editing.state, "The fit of the set was stopped by another frame or another case. Start it again.",
               false);
    return true;
  }
  // The list is brought into view once all of it is there.
  if (editing.work.set_enters && editing.shown.at_rest()) {
    editing.work.set_enters = false;
    editing.state.wanted_section = structures_section;
    ++editing.state.section_wanted;
  }
  if (!fitter.busy() && !editing.shown.at_rest()) return false;  // an edit on its way may take the next ids
  auto done = fitter.take();
  if (!done) return fitter.busy();
  if (!*done)
    add_notice(editing.state, done->error().sentence());
  else if (of_this)
    take_set_fit(editing, **done);
  return true;
}

std::vector<std::string> names_in_map(const TemplateSet& set, const ShownLabels& labels) {
  std::vector<std::string> names;
  for (const TemplateOfSet& one : set.structures) {
    const auto holds_it = [&](const LabelMapLayer& layer) {
      const bool named = std::ranges::any_of(layer.names, [&](const auto& label) {
        return name_likeness(label.second, one.name) != NameLikeness::none || is_same_vertebra(label.second, one.name);
      });
      return named ||
             (!layer.names.contains(one.value) && std::ranges::find(layer.values, one.value) != layer.values.end());
    };
    if (std::ranges::any_of(labels.layers, holds_it)) names.push_back(one.name);
  }
  return names;
}

}  // namespace homolog
