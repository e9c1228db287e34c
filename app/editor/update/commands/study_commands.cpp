#include "app/editor/update/commands/study_commands.h"

#include <memory>
#include <utility>

#include "app/editor/state/models/gallery.h"
#include "app/editor/update/commands/spelling.h"
#include "app/editor/update/editing.h"
#include "app/editor/update/results/write_beside.h"
#include "core/base/files/files.h"
#include "core/catalogue/catalogue.h"
#include "core/model/files/landmark_table.h"
#include "core/model/files/statismo.h"
#include "core/model/measures/leave_one_out.h"

namespace homolog {

namespace {

void close_label_dialog(EditorState& state) {
  if (state.dialog && std::holds_alternative<LabelDialog>(*state.dialog)) state.dialog.reset();
}

}  // namespace

void open_study(Editing& editing, const std::filesystem::path& path) {
  editing.work.models.open_study(editing.state.models, path);
}

void new_study(Editing& editing, const std::filesystem::path& path) {
  editing.work.models.new_study(editing.state.models, path);
}

void save_study_as(Editing& editing, const std::filesystem::path& path) {
  editing.work.models.save_study_as(editing.state.models, path);
}

void open_phantom_study(Editing& editing, Organ organ) {
  editing.work.models.open_phantom_study(organ);
}

void cancel_study_file(Editing& editing, const std::string& subject) {
  editing.work.models.cancel_file(subject);
}

void ExportModel::run(Editing& editing) const {
  const ModelsState& models = editing.state.models;
  if (models.made.model)
    write_beside(editing, path, [of = models.made.model](const auto& to, Progress&) {
      ShapeModel model = of->model;
      model.left_out_distances = left_out_distances(*of->components, model.modes());
      return write_model(model, to);
    });
}

void ExportEvaluation::run(Editing& editing) const {
  const ModelsState& models = editing.state.models;
  if (models.made.evaluation)
    write_beside(editing, path,
                 [of = models.made.evaluation](const auto& to, Progress&) { return write_evaluation(*of, to); });
}

void ExportSizes::run(Editing& editing) const {
  write_beside(editing, path, [listed = listed_sizes(editing.state.models)](const auto& to, Progress&) {
    return write_whole_file(to, sizes_table(listed.names, listed.sizes, listed.groups));
  });
}

void ExportLandmarkTable::run(Editing& editing) const {
  const ListedSizes listed = listed_sizes(editing.state.models);
  std::vector<Specimen> specimens;
  for (std::size_t k = 0; k < listed.names.size(); ++k)
    specimens.push_back({listed.names[k], listed.sizes[k].landmarks});
  write_beside(editing, path, [specimens](const auto& to, Progress&) -> Result<void> {
    const auto written = write_landmark_table(specimens, to);
    return written ? Result<void>{} : fail(written.error());
  });
}

void CompareObservers::run(Editing& editing) const {
  ModelsState& models = editing.state.models;
  models.observer.comparison.reset();
  models.observer.outdated = false;
  models.observer.study = path;
  models.observer.compared_shapes = models.shapes.fitted.shapes;
  editing.work.observers.start(path.string(), [path = path, mine = models.shapes.fitted.shapes](Progress& progress) {
    const auto read = read_observer(path, &progress);
    if (!read) return Result<ObserverComparison>(fail(read.error()));
    auto compared = compare_observers(mine, read->shapes, &progress);
    if (!compared && compared.error().subject.empty())
      return Result<ObserverComparison>(fail("This study and " + path.string(), compared.error().what));
    return compared;
  });
}

void cancel_comparison(Editing& editing) {
  editing.work.observers.cancel();
}

void ExportObservers::run(Editing& editing) const {
  if (editing.state.models.observer.comparison)
    write_beside(editing, path,
                 [table = observers_table(*editing.state.models.observer.comparison)](const auto& to, Progress&) {
                   return write_whole_file(to, table);
                 });
}

void ExportPlots::run(Editing& editing) const {
  if (editing.state.models.made.evaluation)
    write_picture_beside(editing, path,
                         editing.pictures.plots({std::nullopt, 1800, 560, editing.state.saving.picture.transparent,
                                                 editing.state.saving.picture.light}));
}

void ExportReport::run(Editing& editing) const {
  const auto& models = editing.state.models;
  if (!editing.work.write_report || models.kept.file.empty()) return;
  const auto warnings = std::make_shared<std::vector<std::string>>();
  // The recipe that the template has measures the modes. It is looked for now, since the study may change.
  const std::string source = models.study.template_file.string();
  std::error_code ignored;
  const bool measures =
      (is_built_in(source) || std::filesystem::exists(source, ignored)) && !recipe_of_template(source).empty();
  editing.work.exports.start(
      path,
      [write = editing.work.write_report, study = models.kept.file, alignment = models.made.alignment, to = path,
       the_template = measures ? source : std::string(), warnings](Progress& progress) -> Result<void> {
        auto written = write(study, alignment, the_template, to, progress);
        if (!written) return fail(written.error());
        *warnings = std::move(*written);
        return {};
      },
      [&editing, warnings] {
        for (const std::string& warning : *warnings) add_notice(editing.state, warning, false);
      });
}

void ChooseShapesFolder::spell(Fields& line) {
  line.member("extension", extension);
  line.member("name", name);
}
void ChooseShapesFolder::run(EditorState& state, const ControlsContext&, Outbox& out) const {
  state.models.export_extension = extension;
  out.send(ShowFileDialog{FilePurpose::export_shapes, name});
}

void ExportShapes::spell(Fields& line) {
  line.member("folder", folder);
  line.member("extension", extension);
}
void ExportShapes::run(Editing& editing) const {
  editing.work.models.export_shapes(*this, editing.state.models);
}

void start_evaluation(Editing& editing) {
  editing.work.models.start_evaluation(editing.state.models);
}

void cancel_evaluation(Editing& editing) {
  editing.work.models.cancel_evaluation();
}

void AddCases::spell(Fields& line) {
  line.member("paths", paths);
}
void AddCases::run(Editing& editing) const {
  ModelsState& models = editing.state.models;
  std::error_code ignored;
  if (paths.size() == 1 && std::filesystem::is_directory(paths.front(), ignored))
    return add_scans(editing, paths);  // dropped on the window
  if (add_cases(models, paths) == 0) add_notice(editing.state, "All these shapes are in the study already.", false);
  if (models.kept.file.empty()) start_new_study(editing.state);
  if (editing.state.dialog && !paths.empty()) editing.state.preferences.folder = paths.front().parent_path();
}

void AddScans::spell(Fields& line) {
  std::filesystem::path one = paths.size() == 1 ? paths.front() : std::filesystem::path();
  line.optional("path", one, paths.size() == 1);
  line.optional("paths", paths, paths.size() != 1);
  if (line.reads() && !one.empty()) paths = {one};
}
void AddScans::run(Editing& editing) const {
  add_scans(editing, paths);
}

void FitWaiting::spell(Fields& line) {
  line.optional("label", label, label != 0);
  line.optional("all_labels", all_labels, all_labels);
}
void FitWaiting::run(Editing& editing) const {
  close_label_dialog(editing.state);
  fit_waiting(editing, label, all_labels);
}

void MakeStudyTemplate::spell(Fields& line) {
  FileCommand::spell(line);
  line.optional("label", label, label != 0);
  line.optional("all_labels", all_labels, all_labels);
}
void MakeStudyTemplate::run(Editing& editing) const {
  close_label_dialog(editing.state);
  make_study_template(editing, path, label, all_labels);
}

void OpenCaseOfStudy::spell(Fields& line) {
  line.member("name", name);
  std::optional<std::int64_t> at;
  if (vertex) at = *vertex;
  line.optional("vertex", at);
  if (at) vertex = *at;
}
void OpenCaseOfStudy::run(Editing& editing) const {
  editing.work.models.open_case(*this, editing.state, editing.shown.snapshot(), editing.out);
}

void SetCaseState::spell(Fields& line) {
  line.member("name", name);
  spell_choice(line, "to", case_state_names, to);
}
void SetCaseState::run(EditorState& state) const {
  set_case_state(state.models, name, to);
}

void SetCaseText::spell(Fields& line) {
  line.member("name", name);
  line.member("field", field);
  line.member("text", text);
}
void SetCaseText::run(EditorState& state) const {
  set_case_text(state.models, name, field, text);
  state.models.list.text_edit.reset();
}

}  // namespace homolog
