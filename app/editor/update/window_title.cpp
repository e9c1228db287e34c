#include "app/editor/update/window_title.h"

#include "core/catalogue/catalogue.h"
#include "core/session/unsaved_cases.h"

namespace homolog {

namespace {

/// What runs beside the window, in words; empty where nothing does.
std::string running_words(const EditorState& state, const Work& work) {
  if (work.opener.running()) return "opening";
  if (work.fitter.busy()) return work.fitter.refining() ? "refining" : "fitting";
  if (work.template_maker.busy()) return "making a template";
  if (work.contour_fits.busy()) return "fitting";
  if (work.snaps.busy()) return "snapping";
  if (work.exports.running()) return "writing";
  if (state.models.runs.evaluating) return "measuring";
  if (state.models.made.optimisation.runs()) return "optimising";
  if (state.models.runs.modelling) return "making the model";
  return {};
}

}  // namespace

std::string case_title(const Snapshot& snapshot) {
  const auto& file = snapshot.file;
  if (!file.empty() && file.parent_path() != unsaved_folder()) return file.filename().string();
  const Document& document = *snapshot.document;
  if (is_phantom(document.scan.source)) return "Demo case";
  if (!document.scan.source.empty()) return std::filesystem::path(document.scan.source).filename().string();
  return "No image";
}

std::string study_title(const ModelsState& state) {
  const std::string name = study_name(state.kept.file);
  return name.empty() ? "No study" : name;
}

std::string window_title(const EditorState& state, const Snapshot& snapshot, const Work& work) {
  std::string title = state.models.shown ? study_title(state.models) : case_title(snapshot);
  if (!state.models.shown && has_unsaved_edits(snapshot)) title += ", not saved";
  if (const std::string runs = running_words(state, work); !runs.empty()) title += ", " + runs;
  return title + " \xe2\x80\x93 Homolog";
}

}  // namespace homolog
