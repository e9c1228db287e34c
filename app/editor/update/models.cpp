#include "app/editor/update/models.h"
#include "app/editor/state/views.h"
#include "app/editor/work/models/study_folder.h"

#include <algorithm>
#include <system_error>

#include "core/base/files/files.h"
#include "core/base/files/paths.h"
#include "core/base/numbers/index.h"
#include "core/base/processes/memory.h"
#include "core/mesh/mesh_quality.h"
#include "core/model/files/statismo.h"
#include "core/model/shapes/case_of_shape.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

bool is_study_case(const Study& study, const fs::path& file) {
  return !file.empty() &&
         std::any_of(study.cases.begin(), study.cases.end(), [&](const StudyCase& one) { return one.file == file; });
}

/// The open case, where it is one of the study's.
std::shared_ptr<const Document> open_document(const ModelsState& state, const Snapshot& snapshot) {
  return is_study_case(state.study, snapshot.file) ? snapshot.document : nullptr;
}

void tell(EditorState& state, const Result<void>& done, const fs::path& path) {
  add_notice(state, done ? "Written: " + path.string() : done.error().sentence(), !done);
}

}  // namespace

fs::path new_study_file() {
  std::error_code ignored;
  make_folder(studies_folder(), Readers::user_alone);  // what is wrong is said where the study is written
  for (int number = 1;; ++number) {
    const fs::path path = studies_folder() / ("study-" + std::to_string(number) + ".study.json");
    if (!fs::exists(path, ignored)) return path;
  }
}

void start_new_study(EditorState& state) {
  state.models.kept.file = new_study_file();
  remember_recent(state.preferences.recent_studies, state.models.kept.file);
  add_notice(state,
             "The new study lies in " + state.models.kept.file.string() +
                 ". Save study as… (Ctrl+S) puts it beside your scans.",
             false);
}

void Models::show_study(EditorState& state, StudyRead read, const fs::path& path) {
  if (!unwritten_.empty())
    return add_notice(state, path.filename().string() + " was not opened: " + unwritten_.filename().string() +
                                 " could not be written, and its changes would be lost. Save that study under "
                                 "another name first.");
  // What was edited while this one was read belongs to the study before, and is written first.
  if (!study_is_written(state.models)) return open_study(state.models, path);
  // What was said of the study before does not concern this one.
  std::erase_if(state.notices, [&](const Notice& notice) {
    return std::find(told_.begin(), told_.end(), notice.text) != told_.end();
  });
  told_.clear();
  tell_once(state, read.warnings, true);
  const fs::path file = absolute_path(path), before = state.models.kept.file;
  if (before != file && before.parent_path() == studies_folder() && !state.models.study.cases.empty())
    add_notice(state, {"The study " + study_name(before) + " is kept.", false, std::nullopt, before});
  if (file.parent_path() != before.parent_path()) state.saving.saved_folder.clear();
  remember_recent(state.preferences.recent_studies, file);
  homolog::show_study(state.models, std::move(read.study), file);
  written_revision_ = state.models.kept.revision;
}

Result<Models::FileDone> Models::read_of(const fs::path& path, const Progress& progress, Models& shows) {
  auto read = read_study(path);
  if (!read) return fail(read.error());
  if (progress.cancelled()) return FileDone();
  const auto study = std::make_shared<StudyRead>(std::move(*read));
  return FileDone{
      {}, {}, [&shows, path, study](EditorState& state, Outbox&) { shows.show_study(state, std::move(*study), path); }};
}

void Models::open_study(const ModelsState& models, const fs::path& path) {
  write_if_changed(models);
  files_.queue(
      path.string(), [this, path](Progress& progress) { return read_of(path, progress, *this); }, "Reading study");
}

void Models::new_study(const ModelsState& models, const fs::path& path) {
  write_if_changed(models);
  const auto make = [this, path](Progress& progress) -> Result<FileDone> {
    if (auto written = write_study({}, path); !written) return fail(written.error());
    return read_of(path, progress, *this);
  };
  files_.queue(path.string(), make, "Writing study");
}

void Models::queue_writing(const ModelsState& models, const fs::path& path, Then then) {
  const auto write = [study = models.study, path, then = std::move(then)](Progress&) -> Result<FileDone> {
    const auto written = guarded(path.string(), [&]() -> Result<void> {
      // Its own folder may not be there yet: making it failed before, or it was removed.
      if (path.parent_path() == studies_folder())
        if (auto made = make_folder(studies_folder(), Readers::user_alone); !made) return made;
      return write_study(study, path);
    });
    return FileDone{path, written, then};
  };
  files_.queue(path.string(), write, "Writing study");
}

void Models::save_study_as(const ModelsState& models, const fs::path& path) {
  const auto then = [this, path, from = models.kept.file, revision = models.kept.revision](EditorState& state,
                                                                                           Outbox&) {
    if (state.models.kept.file == from) {  // else another one was opened meanwhile
      state.models.kept.file = absolute_path(path);
      remember_recent(state.preferences.recent_studies, path);
      written_revision_ = revision;  // what was edited meanwhile is not in that file yet
      unwritten_.clear();
    }
    tell(state, {}, path);
  };
  queue_writing(models, path, then);
}

void Models::write_study_file(const ModelsState& models) {
  written_revision_ = models.kept.revision;
  unwritten_.clear();
  if (!models.kept.file.empty()) queue_writing(models, models.kept.file, {});
}

bool Models::write_if_changed(const ModelsState& models) {
  if (study_is_written(models)) return false;
  write_study_file(models);
  return true;
}

bool Models::take_files(EditorState& state, Outbox& out) {
  bool any = false;
  while (auto done = files_.take()) {
    any = true;
    if (!*done) {
      add_notice(state, done->error().sentence());
    } else if (const Result<void>& written = (*done)->written; !written) {
      unwritten_ = (*done)->path;
      add_notice(state, written.error().sentence());
    } else {
      if (unwritten_ == (*done)->path) unwritten_.clear();  // a later writing than the one that failed
      if ((*done)->then) (*done)->then(state, out);
    }
  }
  return any;
}

std::vector<std::string> Models::close(ModelsState& models) {
  write_if_changed(models);
  files_.finish();
  std::vector<std::string> faults;
  while (auto done = files_.take()) {
    if (!*done) faults.push_back(done->error().sentence());
    if (*done && !(*done)->written) faults.push_back((*done)->written.error().sentence());
  }
  return faults;
}

void Models::open_phantom_study(Organ organ) {
  phantoms_.start("The phantom study", [organ](Progress& progress) {
    return make_phantom_study(organ, studies_folder() / ("phantom-" + std::string(organ_name(organ))), progress);
  });
}

void Models::start_evaluation(const ModelsState& models) {
  if (!models.made.model) return;
  if (models.made.model->components->shapes() < 3 || models.made.model->model.modes() < 1)
    return;  // there is nothing to measure
  evaluator_.start("The measures", [model = models.made.model](Progress& progress) -> Result<Evaluated> {
    const auto most = static_cast<int>(model->components->shapes()) - 2;
    const EvaluationOptions options{{std::min(most, static_cast<int>(model->model.modes()))}};
    auto evaluation = evaluate_model(*model->components, model->topology, options, &progress);
    if (!evaluation) return fail(evaluation.error());
    return Evaluated{model, std::move(*evaluation)};
  });
}

void Models::open_case(const OpenCaseOfStudy& command, EditorState& state, const Snapshot& snapshot, Outbox& out) {
  ModelsState& models = state.models;
  const StudyCase* one = find_case(models.study, command.name);
  if (one == nullptr) return;
  if (!is_case_file(one->file)) return repair_case(*one, command, state);
  models.repair = RepairPlace{one->file, one->frame, command.vertex, one->structure};
  models.shown = false;
  if (snapshot.file != one->file) {
    OpenRequested open = open_case_file(one->file);
    open.request.labels = one->labels;
    return out.send(std::move(open));
  }
  if (const auto frame = show_repair(state, snapshot)) out.send(ShowFrame{*frame});
}

void Models::repair_case(const StudyCase& one, const OpenCaseOfStudy& command, EditorState& state) {
  const ModelsState& models = state.models;
  const auto file = models.shapes.files.find(one.file);
  if (file == models.shapes.files.end())
    return add_notice(state,
                      one.name + ": its file could not be read; check the file, or remove the case from the study.");
  const std::string subject = "the case of " + one.name;
  if (const auto now = files_.running(); now && now->subject == subject) return;  // asked for twice
  const auto make = [command, mesh = file->second.shapes.structures.front().frames.at(0), mesh_file = one.file,
                     faces = models.made.model ? models.made.model->topology : nullptr,
                     folder = models.kept.file.parent_path() / "repaired"](Progress& progress) -> Result<FileDone> {
    if (progress.cancelled()) return FileDone();
    const auto made = make_case_of_shape(*mesh, faces, command.name, folder);
    if (!made) return fail(made.error());
    if (progress.cancelled()) return FileDone();
    return FileDone{{}, {}, [command, mesh_file, case_file = *made](EditorState& now, Outbox& out) {
                      take_repair_case(command, mesh_file, case_file, now, out);
                    }};
  };
  files_.queue(subject, make, "Making");
}

void Models::take_repair_case(const OpenCaseOfStudy& command, const fs::path& mesh_file, const fs::path& case_file,
                              EditorState& state, Outbox& out) {
  StudyCase* repaired = find_case(state.models.study, command.name);
  if (repaired == nullptr || repaired->file != mesh_file) return;  // another study, or another file by now
  repaired->imported = std::exchange(repaired->file, case_file);
  ++state.models.kept.shapes_revision;
  ++state.models.kept.revision;
  add_notice(state,
             command.name + " is now the case repaired/" + case_file.filename().string() + ". The file " +
                 mesh_file.filename().string() + " stays as it is.",
             false);
  out.send(command);
}

void Models::export_shapes(const ExportShapes& command, const ModelsState& models) {
  std::vector<NamedShape> shapes;
  for (const StudyCase& one : models.study.cases) {
    const auto shape = models.shapes.shown.find(one.name);
    if (shape == models.shapes.shown.end()) continue;
    const bool is_case = is_case_file(one.file);
    const auto fitted = models.shapes.fitted.shapes.find(one.name);
    const bool slid = fitted != models.shapes.fitted.shapes.end() && fitted->second != shape->second;
    shapes.push_back({one.name, shape->second, is_case ? one.imported : one.file, is_case || one.flipped || slid});
  }
  const std::string says =
      "Written: " + command.folder.string() + (models.made.optimisation.shown ? " (optimised)" : "");
  exporter_.start(command.folder.string(),
                  [shapes = std::move(shapes), command, says](Progress& progress) -> Result<std::string> {
                    if (auto written = write_shapes(shapes, command.extension, command.folder, &progress); !written)
                      return fail(written.error());
                    return says;
                  });
}

std::optional<int> Models::show_repair(EditorState& state, const Snapshot& snapshot) {
  const auto repair = std::exchange(state.models.repair, std::nullopt);
  if (!repair || repair->file != snapshot.file) return std::nullopt;
  const Document& document = *snapshot.document;
  const int frame = repair->frame.value_or(document.frame);
  const Structure* structure = document.structure(repair->structure);
  const Shape* shape = structure != nullptr ? structure->shape(frame) : nullptr;
  if (shape == nullptr) return std::nullopt;
  show_structure(state, document, repair->structure);
  const Points& points = *shape->points;
  if (repair->vertex && *repair->vertex < points.rows()) {
    const Mesh mesh{structure->the_template->topology, points};
    const auto vertex = static_cast<std::int32_t>(*repair->vertex);
    look_closely(state, mesh, vertex);
    state.found.finding = ShownFinding{{FindingKind::suspicious, vertex, {}, 1}, 1, 1};
    state.hand.tool = MouseTool::slide;
  }
  return frame == document.frame ? std::nullopt : std::optional(frame);
}

void Models::build(EditorState& state, const Snapshot& snapshot) {
  ModelsState& models = state.models;
  built_revision_ = models.kept.shapes_revision;
  built_alignment_ = models.made.alignment;
  built_document_ = open_document(models, snapshot);
  std::vector<StudyCase> cases = models.study.cases;
  std::erase_if(cases, [](const StudyCase& one) { return one.waits(); });  // they have no shape of their own
  StudyModelRequest request{std::move(cases),      models.study.template_file,
                            models.made.alignment, models.shapes.files,
                            built_document_,       snapshot.file};
  builder_.start("The study's model", [request = std::move(request)](Progress& progress) {
    auto built = build_study_model(request, progress);
    give_back_freed_memory();
    return built;
  });
}

void Models::check(const ModelsState& models) {
  if (checked_ == models.made.model) return;
  checked_ = models.made.model;
  checker_.cancel();
  if (!models.made.model) return;
  std::vector<std::shared_ptr<const MeshFile>> meshes(models.made.model->names.size());
  for (const StudyCase& one : models.study.cases) {
    const auto shape = models.made.model->index_of(one.name);
    const auto file = models.shapes.files.find(one.file);
    if (shape < 0 || file == models.shapes.files.end()) continue;
    if (auto mesh = file->second.shapes.shape({one.structure, one.frame}, one.name))
      meshes[index(shape)] = std::move(*mesh);
  }
  const auto look = [model = models.made.model, meshes = std::move(meshes),
                     known = known_doubts_](Progress& progress) mutable -> Result<Checked> {
    auto found = find_suspicions(*model, meshes, known, progress);
    give_back_freed_memory();
    if (!found) return fail(found.error());
    return Checked{model, std::make_shared<const Suspicions>(std::move(*found)), std::move(known)};
  };
  checker_.start("What is unusual", look);
}

bool Models::take_checked(ModelsState& models) {
  auto checked = checker_.take();
  if (!checked || !*checked) return checked.has_value();
  known_doubts_ = std::move((*checked)->known);
  if ((*checked)->model == models.made.model) models.made.suspicions = std::move((*checked)->suspicions);
  return true;
}

void Models::show_built(EditorState& state, StudyModelBuilt built) {
  state.models.shapes.files = std::move(built.known);
  state.models.shapes.mirrored = std::move(built.mirrored);
  const std::string over =
      take_fitted(state.models, {std::move(built.shapes), std::move(built.sizes), std::move(built.model)});
  if (!over.empty()) add_notice(state, over, false);
  state.models.made.error = std::move(built.error);
  // Where nothing can be read the window says so itself.
  if (state.models.made.model || state.models.made.error.empty() || !state.models.shapes.shown.empty())
    tell_once(state, built.refusals, true);
  tell_once(state, built.warnings, false);
}

void Models::tell_once(EditorState& state, const std::vector<std::string>& sentences, bool error) {
  constexpr std::size_t most = 3;
  std::vector<std::string> fresh;
  for (const std::string& sentence : sentences)
    if (std::find(told_.begin(), told_.end(), sentence) == told_.end()) fresh.push_back(sentence);
  told_.insert(told_.end(), fresh.begin(), fresh.end());
  const std::size_t shown = fresh.size() > most ? 1 : fresh.size();
  for (std::size_t k = 0; k < shown; ++k) add_notice(state, fresh[k], error);
  if (fresh.size() > shown)
    add_notice(state, std::to_string(fresh.size() - shown) + " more cases have similar problems.", error);
}

bool Models::busy() const {
  return builder_.busy() || checker_.busy() || phantoms_.busy() || evaluator_.busy() || exporter_.busy() ||
         files_.busy();
}

bool Models::update(EditorState& state, const Snapshot& snapshot, double seconds, Outbox& out) {
  ModelsState& models = state.models;
  bool changed = take_files(state, out);
  if (auto made = phantoms_.take()) {
    if (*made)
      open_study(models, **made);
    else
      add_notice(state, made->error().sentence());
    changed = true;
  }
  if (auto exported = exporter_.take()) {
    add_notice(state, *exported ? **exported : exported->error().sentence(), !*exported);
    changed = true;
  }
  // One writing at a time: what is edited meanwhile goes into the next.
  if (has_to_write(models) && !files_.busy()) write_study_file(models);
  const bool stale = built_revision_ != models.kept.shapes_revision || built_alignment_ != models.made.alignment ||
                     built_document_ != open_document(models, snapshot);
  if (models.shown && stale) build(state, snapshot);
  if (auto built = builder_.take()) {
    if (*built)
      show_built(state, std::move(**built));
    else
      models.made.error = built->error().sentence();
    changed = true;
  }
  check(models);
  changed = take_checked(models) || changed;
  if (auto evaluated = evaluator_.take()) {
    if (!*evaluated)
      add_notice(state, evaluated->error().sentence());
    else if ((*evaluated)->model == models.made.model)
      models.made.evaluation = std::make_shared<const Evaluation>(std::move((*evaluated)->evaluation));
    changed = true;
  }
  const bool working = busy();
  changed = changed || working || working != (models.runs.modelling || models.runs.evaluating || models.runs.exporting);
  models.runs.modelling = builder_.busy() || phantoms_.busy();
  models.runs.modelling_fraction = phantoms_.busy() ? phantoms_.fraction() : builder_.fraction();
  models.runs.evaluating = evaluator_.busy();
  models.runs.evaluating_fraction = evaluator_.fraction();
  models.runs.exporting = exporter_.busy();
  models.runs.exporting_fraction = exporter_.fraction();
  if (models.shown && models.view.animated_mode) {
    animate(models, seconds);
    changed = true;
  }
  return changed;
}

std::optional<double> Models::next_move_seconds(const ModelsState& state) const {
  constexpr double progress_seconds = 0.1, animation_seconds = 1.0 / 30;
  if (state.shown && state.view.animated_mode) return animation_seconds;
  if (state.runs.modelling || state.runs.evaluating || state.runs.exporting) return progress_seconds;
  return std::nullopt;
}

void Models::settle(EditorState& state, const Snapshot& snapshot, Outbox& out) {
  phantoms_.finish();
  update(state, snapshot, 0, out);
  files_.finish();
  update(state, snapshot, 0, out);
  builder_.finish();
  update(state, snapshot, 0, out);
  checker_.finish();
  evaluator_.finish();
  exporter_.finish();
  update(state, snapshot, 0, out);
}

}  // namespace homolog
