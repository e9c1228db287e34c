#include "app/editor/update/models.h"
#include "app/editor/work/models/study_folder.h"

#include <algorithm>

#include "core/base/numbers/index.h"
#include "core/base/processes/memory.h"
#include "core/model/files/statismo.h"

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

}  // namespace

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
    if (auto mesh = file->second.shapes.shape({one.structure, one.frame}, one.name)) meshes[shape] = std::move(*mesh);
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
