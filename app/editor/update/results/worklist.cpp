#include "app/editor/update/results/worklist.h"

#include <algorithm>
#include <set>
#include <system_error>
#include <utility>

#include "app/editor/update/editing.h"
#include "core/base/files/file_stem.h"

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// The study's case that is on the screen; null where it is none.
StudyCase* case_on_screen(Editing& editing) {
  const Snapshot& snapshot = editing.shown.snapshot();
  if (snapshot.file.empty()) return nullptr;
  const StudyCase* one =
      find_case(editing.state.models, snapshot.file, *snapshot.document, editing.state.look.structure);
  return one == nullptr ? nullptr : find_case(editing.state.models.study, one->name);
}

void take_added(EditorState& state, std::vector<StudyCase> added) {
  ModelsState& models = state.models;
  std::size_t count = 0, known_already = 0;
  auto& cases = models.study.cases;
  std::set<std::string> names;
  std::set<std::filesystem::path> files;
  for (const StudyCase& one : cases) {
    names.insert(one.name);
    files.insert(one.file);
  }
  for (StudyCase& one : added) {
    if (!files.insert(one.file).second) {
      ++known_already;
      continue;
    }
    const std::string stem = one.name;
    for (int number = 2; !names.insert(one.name).second; ++number) one.name = stem + "-" + std::to_string(number);
    cases.push_back(std::move(one));
    ++count;
  }
  if (count > 0) ++models.kept.shapes_revision, ++models.kept.revision;
  std::string news = count == 0   ? "The scans of this folder are in the study already."
                     : count == 1 ? "1 scan was added."
                                  : std::to_string(count) + " scans were added.";
  if (count > 0 && known_already > 0)
    news += known_already == 1 ? " 1 is in the study already."
                               : " " + std::to_string(known_already) + " are in the study already.";
  const std::size_t with_map = cases_with_labels(models);
  if (count > 0 && with_map >= enough_for_consensus && with_map < count + enough_for_consensus)
    news += " A template of all of them depends on no single one: Study, then Make a consensus template.";
  add_notice(state, std::move(news), false);
}

void take_fitted(EditorState& state, const WorklistDone& done) {
  StudyCase* one = find_case(state.models.study, done.fitted);
  if (one == nullptr || one->file != done.file) return;  // another study by now
  one->doubt = done.fault.empty() ? done.doubt : "Could not be fitted: " + done.fault;
  if (done.fault.empty()) one->state = CaseState::in_work;
  ++state.models.kept.shapes_revision;
  ++state.models.kept.revision;
}

/// A map holds several labels, and none was chosen: nothing more is done until one is. `template_file`: of the template
/// that was to be made; empty: cases were to be fitted.
void ask_for_label(Editing& editing, const std::string& map, std::vector<Segment> labels,
                   const fs::path& template_file) {
  editing.work.worklist.cancel();
  if (editing.state.dialog)
    add_notice(editing.state, map + " holds several labels. Ask again, and choose one.", false);
  else
    editing.state.dialog = LabelDialog{map, std::move(labels), template_file};
}

std::string counted_cases(std::size_t count) {
  return count == 1 ? "1 case" : std::to_string(count) + " cases";
}

/// `study`: that it was made for.
void take_template(EditorState& state, const StudyTemplate& made, const fs::path& study) {
  if (state.models.kept.file == study) set_study_template(state.models, made.file);
  std::string news =
      "The template of " + counted_cases(made.subjects) + " was saved as " + made.file.filename().string() + ".";
  if (made.begun > 0)
    news += made.begun == 1 ? " The waiting case begins with it." : " The waiting cases begin with it.";
  if (!made.stays.empty())
    news += " " + counted_cases(made.stays.size()) + " that you worked on " +
            (made.stays.size() == 1 ? "keeps its" : "keep their") + " own.";
  for (const std::string& warning : made.warnings) add_notice(state, warning, false);
  add_notice(state, std::move(news), false);
  ++state.models.kept.shapes_revision;
  ++state.models.kept.revision;
}

/// Where the case files of scans go: a folder of the study's own, "NAME-cases" beside it, or where those lie that it
/// has already.
fs::path case_folder(const ModelsState& models) {
  for (const StudyCase& one : models.study.cases)
    if (one.from_scan) return one.file.parent_path();
  return models.kept.file.parent_path() / (file_stem(models.kept.file) + "-cases");
}

/// Once all that was asked for is done.
void tell_end(EditorState& state) {
  const auto& cases = state.models.study.cases;
  const auto doubts =
      std::count_if(cases.begin(), cases.end(), [](const StudyCase& one) { return !one.doubt.empty(); });
  if (doubts > 0)
    add_notice(state,
               std::to_string(doubts) + (doubts == 1 ? " case is" : " cases are") +
                   " in doubt and listed first. N selects the next one.",
               false);
  if (state.models.list.sorted_by != CaseColumn::study) sort_by(state.models, state.models.list.sorted_by);
  select_next_case(state.models);
}

}  // namespace

void add_scans(Editing& editing, const std::vector<fs::path>& paths) {
  if (paths.empty()) return;
  ModelsState& models = editing.state.models;
  const std::string of_study = models.study.template_file.string();
  const auto& the_template = editing.shown.loaded_template();
  if (of_study.empty() && !the_template)
    return add_notice(editing.state, "Load the template first (Tab, then Template); every scan starts from it.");
  if (models.kept.file.empty()) start_new_study(editing.state);
  std::error_code ignored;
  CaseStart start;
  start.cases = case_folder(models);
  if (of_study.empty() || (the_template && the_template->source == of_study)) {
    start.the_template = the_template;
    start.mirrored = editing.shown.template_is_mirrored();
  } else {
    start.template_source = of_study;
  }
  for (const StudyCase& one : models.study.cases) start.known.push_back(one.file);
  editing.work.study_of_worklist = models.kept.number;
  if (paths.size() > 1) return editing.work.worklist.add(paths, std::move(start));
  const fs::path& one = paths.front();
  editing.work.worklist.add({fs::is_directory(one, ignored) ? one : one.parent_path()}, std::move(start));
}

void fit_waiting(Editing& editing, int label, bool all_labels) {
  const ModelsState& models = editing.state.models;
  std::vector<StudyCase> waiting;
  for (const StudyCase& one : models.study.cases) {
    if (!one.waits() || one.labels.empty()) continue;
    if (one.file == editing.shown.snapshot().file)
      add_notice(editing.state, one.name + " is open, so it is left out. Fit it there.", false);
    else
      waiting.push_back(one);
  }
  if (waiting.empty()) return add_notice(editing.state, "No case with a label map waits for a fit.", false);
  FitSettings settings = editing.state.automatic.fit_settings;
  settings.label = label;
  settings.all_labels = all_labels;
  if (all_labels)
    add_notice(editing.state, "All labels of each map are fitted together.", false);
  else if (label != 0)
    add_notice(editing.state, "Label " + std::to_string(label) + " is fitted where a map holds several.", false);
  editing.work.study_of_worklist = models.kept.number;
  editing.work.worklist.fit(waiting, settings);
}

void make_study_template(Editing& editing, const fs::path& file, int label, bool all_labels) {
  std::vector<StudyCase> cases;
  for (const StudyCase& one : editing.state.models.study.cases) {
    cases.push_back(one);
    if (one.waits() && one.file == editing.shown.snapshot().file) {
      cases.back().state = CaseState::in_work;  // it is in this program's hands
      add_notice(editing.state, one.name + " is open, so it keeps its template.", false);
    }
  }
  FitSettings settings = editing.state.automatic.fit_settings;
  settings.label = label;
  settings.all_labels = all_labels;
  editing.work.worklist.make_template(cases, settings, file, editing.state.models.kept.file);
}

void cancel_worklist(Editing& editing) {
  if (!editing.work.worklist.busy()) return;
  editing.work.worklist.cancel();
  add_notice(editing.state, "Cancelled. What was fitted stays so.", false);
}

bool take_worklist(Editing& editing) {
  EditorState& state = editing.state;
  Worklist& worklist = editing.work.worklist;
  bool any = false, fitted = false;
  while (auto done = worklist.take()) {
    any = true;
    if (!*done) {
      add_notice(state, done->error().sentence());
      continue;
    }
    for (const std::string& warning : (*done)->warnings) add_notice(state, warning, false);
    if (!(*done)->map.empty()) {
      ask_for_label(editing, (*done)->map, std::move((*done)->labels), {});
      break;
    }
    if ((*done)->made) {
      StudyTemplate& made = *(*done)->made;
      if (!made.map.empty()) {
        ask_for_label(editing, made.map, std::move(made.labels), (*done)->file);
        break;
      }
      take_template(state, made, (*done)->study);
      continue;
    }
    if (editing.work.study_of_worklist != state.models.kept.number) {
      worklist.cancel();
      add_notice(state,
                 "Another study was opened, so adding and fitting scans was stopped. What was made is kept: open the "
                 "study before, and ask again.");
      break;
    }
    fitted = fitted || !(*done)->fitted.empty();
    if ((*done)->fitted.empty())
      take_added(state, std::move((*done)->added));
    else
      take_fitted(state, **done);
  }
  if (fitted && !worklist.busy()) tell_end(state);
  ModelsState& models = state.models;
  const bool was_listing = std::exchange(models.runs.listing, worklist.busy());
  models.runs.listing_what = worklist.what();
  models.runs.listing_fraction = worklist.fraction();
  return any || models.runs.listing || was_listing;
}

void open_next_case(Editing& editing) {
  ModelsState& models = editing.state.models;
  if (models.study.cases.empty())
    return add_notice(editing.state, "No study is open. Press Tab to open one, or to add scans and cases.", false);
  std::ptrdiff_t from = -1;
  if (StudyCase* one = case_on_screen(editing)) {
    from = one - models.study.cases.data();
    one->state = CaseState::done;
    one->doubt.clear();
    ++models.kept.shapes_revision;
    ++models.kept.revision;
  }
  const std::ptrdiff_t next = models.study.next_case(from);
  if (next < 0) return add_notice(editing.state, "Every case of the study is done.", false);
  models.list.selected = models.study.cases[next].name;
  editing.out.send(OpenCaseOfStudy{models.list.selected, {}});
}

void count_work(Editing& editing, std::uint64_t steps_before, double seconds) {
  constexpr double longest_pause = 30;
  WorkCount& count = editing.state.work_count;
  if (count.case_number != editing.shown.number()) {
    count = {editing.shown.number()};
    steps_before = editing.shown.snapshot().steps_made;
  }
  if (std::exchange(editing.state.active, false)) {
    if (count.active_at >= 0) count.seconds += std::clamp(seconds - count.active_at, 0.0, longest_pause);
    count.active_at = seconds;
  }
  const std::uint64_t steps = editing.shown.snapshot().steps_made;
  if (steps <= steps_before) return;
  StudyCase* one = case_on_screen(editing);
  if (one == nullptr) return;
  one->gestures += static_cast<std::int64_t>(steps - steps_before);
  one->seconds += std::exchange(count.seconds, 0);
  if (one->waits()) one->state = CaseState::in_work;
  ++editing.state.models.kept.revision;
}

}  // namespace homolog
