#include "app/editor/update/commands/models_commands.h"

#include <utility>

#include "app/editor/state/models/gallery.h"
#include "app/editor/update/commands/spelling.h"
#include "app/editor/update/editing.h"
#include "app/editor/update/results/imports.h"
#include "app/editor/update/results/worklist.h"
#include "core/base/files.h"
#include "core/model/landmark_table.h"
#include "core/model/statismo.h"

namespace homolog {

namespace {

constexpr std::array state_names{"to do", "in work", "done"};
constexpr std::array column_names{"study", "name", "group", "state", "distance"};
constexpr std::array alignment_names{"similarity", "rigid", "none"};

void spell_place(Fields& line, std::optional<GalleryVertex>& place) {
  bool any = place.has_value();
  line.member("any", any);
  if (!any) return;
  if (!place) place.emplace();
  std::int64_t vertex = place->vertex;
  line.member("shape", place->shape);
  line.member("vertex", vertex);
  place->vertex = vertex;
}

}  // namespace

void OpenStudy::run(Editing& editing) const {
  editing.work.models.open_study(editing.state.models, path);
}

void NewStudy::run(Editing& editing) const {
  editing.work.models.new_study(editing.state.models, path);
}

void SaveStudyAs::run(Editing& editing) const {
  editing.work.models.save_study_as(editing.state.models, path);
}

void SetStudyTemplate::run(EditorState& state) const {
  set_study_template(state.models, path);
}

void OpenPhantomStudy::spell(Fields& line) {
  spell_choice(line, "organ", organ_names, organ);
}
void OpenPhantomStudy::run(Editing& editing) const {
  editing.work.models.open_phantom_study(organ);
}

void CancelStudyFile::spell(Fields& line) {
  line.member("subject", subject);
}
void CancelStudyFile::run(Editing& editing) const {
  editing.work.models.cancel_file(subject);
}

void ExportModel::run(Editing& editing) const {
  const ModelsState& models = editing.state.models;
  if (models.model)
    write_beside(editing, path, [of = models.model](const auto& to, Progress&) { return write_model(of->model, to); });
}

void ExportEvaluation::run(Editing& editing) const {
  const ModelsState& models = editing.state.models;
  if (models.evaluation)
    write_beside(editing, path,
                 [of = models.evaluation](const auto& to, Progress&) { return write_evaluation(*of, to); });
}

void ExportSizes::run(Editing& editing) const {
  write_beside(editing, path, [listed = listed_sizes(editing.state.models)](const auto& to, Progress&) {
    return write_whole_file(to, sizes_table(listed.names, listed.sizes));
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

void ShowDistance::spell(Fields& line) {
  line.member("pair", pair);
}
void ShowDistance::run(EditorState& state) const {
  state.models.distance_shown = pair;
}

void CompareObservers::run(Editing& editing) const {
  ModelsState& models = editing.state.models;
  models.observers.reset();
  models.observers_outdated = false;
  models.other_observer = path;
  editing.work.observers.start(path.string(), [path = path, mine = models.fitted.shapes](Progress& progress) {
    const auto read = read_observer(path, &progress);
    if (!read) return Result<ObserverComparison>(fail(read.error()));
    auto compared = compare_observers(mine, read->shapes, &progress);
    if (!compared && compared.error().subject.empty())
      return Result<ObserverComparison>(fail("This study and " + path.string(), compared.error().what));
    return compared;
  });
}

void CancelObservers::run(Editing& editing) const {
  editing.work.observers.cancel();
}

void ExportObservers::run(Editing& editing) const {
  if (editing.state.models.observers)
    write_beside(editing, path, [table = observers_table(*editing.state.models.observers)](const auto& to, Progress&) {
      return write_whole_file(to, table);
    });
}

void ExportPlots::run(Editing& editing) const {
  if (editing.state.models.evaluation)
    write_picture_beside(editing, path,
                         editing.pictures.plots({std::nullopt, 1800, 560, editing.state.picture.transparent,
                                                 editing.state.picture.light}));
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

void StartEvaluation::run(Editing& editing) const {
  editing.work.models.start_evaluation(editing.state.models);
}

void CancelEvaluation::run(Editing& editing) const {
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
  if (models.study_file.empty()) {
    models.study_file = new_study_file();
    remember_recent(editing.state.preferences.recent_studies, models.study_file);
  }
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
  if (editing.state.dialog && std::holds_alternative<LabelDialog>(*editing.state.dialog)) editing.state.dialog.reset();
  fit_waiting(editing, label, all_labels);
}

void CancelWorklist::run(Editing& editing) const {
  cancel_worklist(editing);
}

void OpenNextCase::run(Editing& editing) const {
  open_next_case(editing);
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

void SelectCase::spell(Fields& line) {
  line.member("name", name);
}
void SelectCase::run(EditorState& state) const {
  state.models.selected = name;
}

void SelectNextCase::run(EditorState& state) const {
  select_next_case(state.models);
}

void RemoveCase::spell(Fields& line) {
  line.member("name", name);
}
void RemoveCase::run(EditorState& state) const {
  remove_case(state.models, name);
}

void SetCaseState::spell(Fields& line) {
  line.member("name", name);
  spell_choice(line, "to", state_names, to);
}
void SetCaseState::run(EditorState& state) const {
  if (StudyCase* one = find_case(state.models.study, name)) one->state = to;
  ++state.models.study_revision;
}

void CycleCaseState::spell(Fields& line) {
  line.member("name", name);
}
void CycleCaseState::run(EditorState& state) const {
  cycle_case_state(state.models, name);
}

void TypeCaseText::spell(Fields& line) {
  line.member("field", field);
  line.member("text", text);
}
void TypeCaseText::run(EditorState& state) const {
  state.models.text_edit = CaseTextEdit{field, text};
}

void SetCaseText::spell(Fields& line) {
  line.member("name", name);
  line.member("field", field);
  line.member("text", text);
}
void SetCaseText::run(EditorState& state) const {
  set_case_text(state.models, name, field, text);
  state.models.text_edit.reset();
}

void FlipCases::spell(Fields& line) {
  line.member("names", names);
}
void FlipCases::run(EditorState& state) const {
  flip_cases(state.models, names);
}

void AddFrames::spell(Fields& line) {
  line.member("name", name);
}
void AddFrames::run(EditorState& state) const {
  add_frames(state.models, name);
}

void FilterCases::spell(Fields& line) {
  line.member("filter", filter);
}
void FilterCases::run(EditorState& state) const {
  state.models.filter = filter;
}

void SortCases::spell(Fields& line) {
  spell_choice(line, "column", column_names, column);
}
void SortCases::run(EditorState& state) const {
  sort_by(state.models, column);
}

void LookFromSideInGallery::spell(Fields& line) {
  spell_choice(line, "side", side_names, side);
}
void LookFromSideInGallery::run(EditorState& state) const {
  look_from(state.models.camera, side);
}

void ShowAllShapes::run(EditorState& state) const {
  show_all_shapes(state.models);
}

void TurnGallery::spell(Fields& line) {
  line.member("right_px", right_px);
  line.member("down_px", down_px);
}
void TurnGallery::run(EditorState& state) const {
  state.models.turning = true;
  state.models.hover.reset();
  state.models.camera = turned(state.models.camera, right_px, down_px);
}

void PanGallery::spell(Fields& line) {
  line.member("right_px", right_px);
  line.member("down_px", down_px);
  line.member("side_px", side_px);
}
void PanGallery::run(EditorState& state) const {
  state.models.turning = true;
  state.models.hover.reset();
  pan_gallery(state.models, right_px, down_px, side_px);
}

void LetGoOfGallery::run(EditorState& state) const {
  state.models.turning = false;
}

void ZoomGallery::spell(Fields& line) {
  line.member("steps", steps);
}
void ZoomGallery::run(EditorState& state) const {
  zoom_gallery(state.models, steps);
}

void PointAtVertex::spell(Fields& line) {
  spell_place(line, place);
}
void PointAtVertex::run(EditorState& state) const {
  state.models.hover = place;
}

void PinVertex::spell(Fields& line) {
  spell_place(line, place);
  line.member("focus", focus);
}
void PinVertex::run(EditorState& state) const {
  if (place)
    pin_vertex(state.models, *place, focus);
  else
    unpin(state.models);
}

void ShowGalleryGlyphs::spell(Fields& line) {
  line.member("shown", shown);
}
void ShowGalleryGlyphs::run(EditorState& state) const {
  state.models.glyphs = shown;
}

void SpaceGalleryGlyphs::spell(Fields& line) {
  line.member("spacing_mm", spacing_mm);
}
void SpaceGalleryGlyphs::run(EditorState& state) const {
  state.models.glyph_spacing_mm = spacing_mm;
}

void ShowMean::run(EditorState& state) const {
  set_to_mean(state.models);
}

void ShowSample::run(EditorState& state) const {
  set_to_sample(state.models);
}

void ShowSelectedShape::run(EditorState& state) const {
  set_to_case(state.models, state.models.selected);
}

void SetMode::spell(Fields& line) {
  line.member("mode", mode);
  line.member("deviations", deviations);
}
void SetMode::run(EditorState& state) const {
  if (mode < state.models.deviations.size()) state.models.deviations[mode] = deviations;
  state.models.animated_mode.reset();
  state.models.show_difference = false;
}

void AnimateMode::spell(Fields& line) {
  line.or_null("mode", mode);
}
void AnimateMode::run(EditorState& state) const {
  state.models.animated_mode = mode;
  state.models.show_difference = false;
  state.models.animation_started = -1;
}

void ShowAllModes::spell(Fields& line) {
  line.member("all", all);
}
void ShowAllModes::run(EditorState& state) const {
  state.models.all_modes = all;
}

void ShowDifference::spell(Fields& line) {
  line.member("shown", shown);
}
void ShowDifference::run(EditorState& state) const {
  state.models.show_difference = shown;
  state.models.animated_mode.reset();
}

void CompareGroup::spell(Fields& line) {
  line.member("which", which);
  line.member("group", group);
}
void CompareGroup::run(EditorState& state) const {
  if (which < state.models.compared.size()) state.models.compared[which] = group;
}

void ChooseAlignment::spell(Fields& line) {
  spell_choice(line, "alignment", alignment_names, alignment);
}
void ChooseAlignment::run(EditorState& state) const {
  state.models.alignment = alignment;
}

}  // namespace homolog
