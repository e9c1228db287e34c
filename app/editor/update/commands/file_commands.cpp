#include "app/editor/update/commands/file_commands.h"

#include <algorithm>
#include <memory>
#include <system_error>
#include <utility>

#include "app/editor/update/commands/spelling.h"
#include "app/editor/update/editing.h"
#include "app/editor/update/file_purposes.h"
#include "app/editor/update/status.h"
#include "app/editor/work/opening/sort_files.h"
#include "core/base/files/files.h"
#include "core/base/files/paths.h"
#include "core/base/text/text.h"
#include "core/mesh/files/slicer_curves.h"
#include "core/session/unsaved_cases.h"
#include "core/structures/template_set.h"

namespace homolog {

namespace {

namespace fs = std::filesystem;

/// Says so where there is nothing to save.
bool nothing_to_save(Editing& editing) {
  const Document& document = editing.shown.document();
  if (document.scan.image || !document.structures.empty()) return false;
  add_notice(editing.state, "There is nothing to save yet. Open an image or a template first.");
  return true;
}

}  // namespace

void OpenFiles::spell(Fields& line) {
  line.member("paths", paths);
}
void OpenFiles::run(Editing& editing) const {
  for (const auto& path : paths)
    if (is_study_file(path)) {
      editing.out.send(ShowModels{true});
      return editing.out.send(OpenStudy{{path}});
    }
  // A template set is chosen, whatever else is opened beside it.
  if (const auto set = std::ranges::find_if(paths, is_template_set); set != paths.end()) {
    std::vector<fs::path> others = paths;
    std::erase(others, *set);
    editing.state.wanted_section = structures_section;
    ++editing.state.section_wanted;
    editing.out.send(ChooseSet{absolute_path(*set).string()});
    return others.empty() ? void() : editing.out.send(OpenFiles{std::move(others)});
  }
  // Dropped on the Models mode, all else becomes a case of the study.
  if (editing.state.models.shown) return editing.out.send(AddCases{paths});
  // Points alone are landmarks.
  const bool points = paths.size() == 1 && lower_case(paths.front().string()).ends_with(".mrk.json") &&
                      !read_slicer_curves(paths.front());
  if (points && editing.shape()) return editing.out.send(ImportLandmarks{{paths.front()}});
  auto request = sort_files(paths);
  if (!request) return add_notice(editing.state, request.error().sentence());
  std::error_code ignored;
  if (!request->case_file.empty() && fs::equivalent(request->case_file, editing.shown.snapshot().file, ignored))
    return add_notice(editing.state, request->case_file.filename().string() + " is open already.", false);
  request->beside = editing.shown.document().scan.image;
  editing.out.send(OpenRequested{std::move(*request)});
}

void OpenRequested::spell(Fields& line) {
  const auto named = [&](const char* name, auto& value) { line.optional(name, value, !value.empty()); };
  named("case_file", request.case_file);
  named("volume", request.volume_source);
  named("other_volume", request.other_source);
  named("series", request.volume_options.series_uid);
  line.optional("stack_spacing_mm", request.volume_options.stack_spacing_mm);
  line.optional("resample", request.volume_options.resample, request.volume_options.resample);
  named("template", request.template_source);
  line.optional("in_place", request.template_in_place, request.template_in_place);
  named("labels", request.labels);
  named("contours", request.contours);
  std::optional<Organ> organ;
  int subject = 1;
  if (request.demo) std::tie(organ, subject) = *request.demo;
  spell_choice_or_null(line, "phantom", organ_names, organ);
  if (line.reads() ? line.has("subject") : request.demo.has_value()) line.count("subject", subject);
  if (line.reads() && organ) request.demo = {*organ, subject};
}
void OpenRequested::run(Editing& editing) const {
  editing.work.opener.start(request, editing.shown.document().scan.image);
}

OpenRequested open_case_file(const fs::path& file) {
  OpenRequested open;
  open.request.case_file = file;
  return open;
}

OpenRequested open_template(const std::string& source) {
  OpenRequested open;
  open.request.template_source = source;
  return open;
}

OpenRequested open_labels(const fs::path& file) {
  OpenRequested open;
  open.request.labels = file;
  return open;
}

OpenRequested open_phantom(Organ organ, int subject) {
  OpenRequested open;
  open.request.demo = {organ, subject};
  return open;
}

void close_labels(Editing& editing) {
  editing.shown.close_labels();
}

void ShowLabelsLayer::spell(Fields& line) {
  line.member("layer", layer);
}
void ShowLabelsLayer::run(Editing& editing) const {
  if (layer == editing.shown.labels().layer) return;
  editing.shown.show_labels_layer(layer);
  // The same value is another label there.
  editing.state.look.hidden_labels.reset();
  editing.state.automatic.fit_settings.label = 0;
}

void set_labels_frame(Editing& editing, int frame) {
  editing.shown.set_labels_frame(frame);
}

void cancel_opening(Editing& editing) {
  editing.work.opener.cancel();
}

void cancel_reading(Editing& editing) {
  editing.work.imports.cancel();
}

void cancel_writing(Editing& editing, const fs::path& path) {
  editing.work.exports.cancel(path);
}

void SaveCase::spell(Fields& line) {
  line.member("as", as);
}
void SaveCase::run(Editing& editing) const {
  if (nothing_to_save(editing)) return;
  const auto& file = editing.shown.snapshot().file;
  if (as || file.empty() || file.parent_path() == unsaved_folder())
    return editing.out.send(ShowFileDialog{FilePurpose::save_case, case_name(file, editing.shown.document())});
  editing.shown.session().save(true);
}

void FileCommand::spell(Fields& line) {
  line.member("path", path);
}

void SaveCaseAs::run(Editing& editing) const {
  if (!nothing_to_save(editing)) editing.shown.session().save_as(path);
}

}  // namespace homolog
