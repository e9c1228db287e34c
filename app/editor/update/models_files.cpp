#include <algorithm>
#include <system_error>
#include <utility>

#include "app/editor/state/views.h"
#include "app/editor/update/models.h"
#include "app/editor/work/models/study_folder.h"
#include "core/base/files/files.h"
#include "core/base/files/paths.h"
#include "core/model/shapes/case_of_shape.h"

// The Models mode's work on files: the study's, and the cases that are opened from it, or made beside it.

namespace homolog {

namespace fs = std::filesystem;

namespace {

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
    add_notice(state, Notice{.text = "The study " + study_name(before) + " is kept.", .error = false, .kept = before});
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

}  // namespace homolog
