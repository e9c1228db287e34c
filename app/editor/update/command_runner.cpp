#include <algorithm>
#include <cmath>

#include "app/editor/editor_app.h"
#include "core/base/picture_io.h"
#include "core/case/unsaved_cases.h"
#include "core/mesh/label_map.h"
#include "core/mesh/landmark_io.h"
#include "core/model/statismo.h"
#include "core/template/template_file.h"

namespace homolog {

/// Does one command; one overload a kind.
struct CommandRunner {
  EditorApp& app;
  EditorState& state = app.state_;

  void operator()(const ChangeState& command) const { command.change(state); }
  void operator()(const PreviewEdit& command) const {
    app.session_->preview(command.action, command.action ? app.assistance(*command.action) : std::vector<Compute>{});
  }
  void operator()(const ApplyEdit& command) const {
    stop_playing();
    app.session_->apply(command.action, command.joined);
  }
  void operator()(const SnapMesh& command) const {
    const Document& document = *app.displayed_;
    if (!document.volume || !document.has_shape())
      return add_notice(state, "A snap needs an image, and a mesh that lies on its organ.", false);
    stop_playing();
    app.snaps_.start(*app.session_, command.region, state.snap, command.joined);
  }
  void operator()(const CancelSnap&) const { app.snaps_.cancel(); }
  void operator()(const OpenFiles& command) const {
    if (state.models.shown) return open_in_models(command.paths);
    auto request = sort_files(command.paths);
    if (!request) return add_notice(state, request.error().sentence());
    std::error_code ignored;
    if (!request->case_file.empty() && std::filesystem::equivalent(request->case_file, app.snapshot_->file, ignored))
      return add_notice(state, request->case_file.filename().string() + " is the case that is open.", false);
    request->beside = app.displayed_->volume;
    app.opener_.start(std::move(*request));
  }
  void operator()(const OpenRequested& command) const { app.opener_.start(command.request); }
  void operator()(const OpenPhantom& command) const {
    OpenRequest request;
    request.demo = {command.organ, command.subject};
    app.opener_.start(std::move(request));
  }
  void operator()(const OpenTemplate& command) const {
    OpenRequest request;
    request.template_source = command.source;
    app.opener_.start(std::move(request));
  }
  void operator()(const OpenLabels& command) const {
    OpenRequest request;
    request.labels = command.path;
    app.opener_.start(std::move(request));
  }
  void operator()(const CloseLabels&) const { app.labels_.reset(); }
  void operator()(const CancelOpening&) const { app.opener_.cancel(); }
  void operator()(const CancelReading&) const { app.work_.cancel(); }
  void operator()(const CancelStudyFile& command) const { app.models_.cancel_file(command.subject); }
  void operator()(const CancelWriting& command) const { app.exports_.cancel(command.path); }
  void operator()(const SaveCase& command) const {
    const auto& file = app.snapshot_->file;
    if (nothing_open()) return add_notice(state, "Nothing is open that could be saved; open an image or a template.");
    if (command.as || file.empty() || file.parent_path() == unsaved_folder())
      return show_file_dialog(state, FilePurpose::save_case, case_name(file, *app.displayed_));
    add_notice(state, "Every edit is on the disk already, in " + file.string(), false);
  }
  void operator()(const SaveCaseAs& command) const {
    if (nothing_open()) return add_notice(state, "Nothing is open that could be saved; open an image or a template.");
    app.session_->save_as(command.path);
  }
  void operator()(const ExportMesh& command) const {
    const Document document = as_done();
    if (!document.has_shape()) return no_mesh_to_export();
    write(command.path, [file = to_mesh_file(document, document.frame)](const auto& path, Progress&) {
      return write_mesh_file(file, path);
    });
  }
  void operator()(const ExportLabelMap& command) const {
    const Document document = as_done();
    if (!document.has_shape() || !document.volume) return no_mesh_to_export();
    write(command.path,
          [mesh = document.mesh(), grid = document.volume->geometry](const auto& path, Progress& progress) {
            return write_volume(label_map(mesh, grid, 1), path, &progress);
          });
  }
  void operator()(const ImportLandmarks& command) const { app.import_landmarks(command.path); }
  void operator()(const ExportLandmarks& command) const {
    const Document document = as_done();
    if (!document.has_shape()) return no_mesh_to_export();
    std::vector<Landmark> placed;
    for (const auto& [name, position] : document.shape().landmarks) placed.push_back({name, position});
    write(command.path, [placed](const auto& path, Progress&) { return write_landmarks(placed, path); });
  }
  void operator()(const ExportTemplate& command) const {
    write(command.path,
          [file = painted_template(as_done())](const auto& path, Progress&) { return write_mesh_file(file, path); });
  }
  void operator()(const ImportStiffness& command) const { app.import_stiffness(command.path); }
  void operator()(const ImportTemplateLandmarks& command) const { app.import_template_landmarks(command.path); }
  void operator()(const ExportTemplateLandmarks& command) const {
    write(command.path, [landmarks = as_done().reference->landmarks](const auto& path, Progress&) {
      return write_landmarks(landmarks, path);
    });
  }
  void operator()(const MakeTemplate&) const {
    TemplateSettings settings = state.template_settings;
    if (!app.labels_) return;
    if (settings.label == 0 && !app.label_values_.empty()) settings.label = app.label_values_.front();
    settings.mask.label = settings.tube_options.label = settings.label;
    settings.mask.frame = settings.tube_options.frame = std::min(app.displayed_->frame, app.labels_->frames - 1);
    settings.tube_options.outer_label =
        settings.outer_label != 0 ? std::optional<int>(settings.outer_label) : std::nullopt;
    if (settings.axis_by_ruler && state.ruler)
      settings.tube_options.base_and_apex = {state.ruler->from, state.ruler->to};
    state.shown_stage.reset();
    app.making_shown_ = true;
    app.template_maker_.start(app.labels_, app.labels_name_, settings);
  }
  void operator()(const CancelTemplate&) const { app.template_maker_.cancel(); }
  void operator()(const UndoTemplate&) const {
    app.template_maker_.undo();
    state.shown_stage.reset();
  }
  void operator()(const CloseTemplateMaking&) const {
    app.making_shown_ = false;
    app.template_maker_.forget();
  }
  void operator()(const UseMadeTemplate& command) const { app.use_made_template(command.path); }
  void operator()(const StartFit&) const {
    if (!app.labels_ || !app.displayed_->has_shape()) return;
    stop_playing();
    FitSettings settings = state.fit_settings;
    if (settings.label == 0 && !app.label_values_.empty()) settings.label = app.label_values_.front();
    state.last_fit.reset();
    app.fit_seen_ = false;
    app.fitter_.start_fit(app.snapshot_->document, {app.labels_, app.labels_name_}, settings);
  }
  void operator()(const RefineLandmarks&) const {
    if (!app.displayed_->has_shape()) return;
    stop_playing();
    app.fitter_.start_refinement(app.snapshot_->document);
  }
  void operator()(const BlendModel& command) const { app.blend_model(command); }
  void operator()(const CompleteByModel&) const {
    if (auto complete = app.model_help_.completion(state.model_help))
      app.session_->apply_computed(std::move(complete), true);
  }
  void operator()(const CancelFit&) const { app.cancel_fit(); }
  void operator()(const ExportPicture& command) const { write_drawn(app.picture(command.options), command.path); }
  void operator()(const ShowRecovery&) const {
    app.offer_ = EditorApp::Offer::asked;
    app.recovery_.look();
  }
  void operator()(const RecoverCase& command) const {
    OpenRequest request;
    request.case_file = command.path;
    app.opener_.start(std::move(request));
  }
  void operator()(const DiscardCase& command) const {
    std::error_code ignored;
    if (Journal::in_use(command.path))
      add_notice(state, "That case was recovered in another window; it is not deleted.");
    else
      std::filesystem::remove(command.path, ignored);
    if (!state.dialog) return;
    auto* recover = std::get_if<RecoverDialog>(&*state.dialog);
    if (recover == nullptr) return;
    std::erase_if(recover->found, [&](const auto& found) { return found.journal == command.path; });
    if (recover->found.empty()) state.dialog.reset();
  }
  void operator()(const AcceptFileDialog&) const {
    if (state.dialog && std::holds_alternative<FileDialog>(*state.dialog)) accept_file_dialog(state, app.out_);
  }
  void operator()(const AcceptReplacement&) const {
    if (state.dialog && std::holds_alternative<ReplaceDialog>(*state.dialog)) accept_replacement(state, app.out_);
  }
  void operator()(const ShowFrame& command) const {
    app.session_->apply(SetFrame{command.frame});
    state.shown_frame.reset();
  }
  void operator()(const PlayFrames& command) const {
    if (command.play)
      state.playing = true;
    else
      stop_playing();
  }
  void operator()(const FitViews&) const { fit_views(state, *app.displayed_, app.layout_); }
  void operator()(const ModelsCommand& command) const {
    if (!write_from_models(command)) app.models_.run(command, state, *app.snapshot_, app.out_);
  }
  void operator()(const Quit& command) const {
    if (has_unsaved_edits(*app.snapshot_) && !command.sure)
      state.dialog = QuitDialog{};
    else
      app.quit_when_written(command.without_study);
  }

 private:
  /// The case as it is done, at the frame that is shown: an export never takes a running preview.
  Document as_done() const {
    Document document = *app.snapshot_->document;
    document.frame = app.displayed_->frame;
    return document;
  }
  void no_mesh_to_export() const {
    add_notice(state, "This frame has no mesh of its own to export yet; start it from another frame.", false);
  }
  bool nothing_open() const { return !app.displayed_->volume && !app.displayed_->reference; }
  /// Dropped on the Models mode: studies are opened, all else becomes a case of the study.
  void open_in_models(const std::vector<std::filesystem::path>& paths) const {
    for (const auto& path : paths)
      if (path.string().ends_with(".study.json")) return app.out_.send(OpenStudy{path});
    app.out_.send(AddCases{paths});
  }
  void stop_playing() const { app.stop_playing(); }
  /// What a command of the Models mode asks to be written; false where it asks for something else.
  bool write_from_models(const ModelsCommand& command) const {
    const ModelsState& models = state.models;
    if (const auto* model = std::get_if<ExportModel>(&command)) {
      if (models.model)
        write(model->path, [of = models.model](const auto& path, Progress&) { return write_model(of->model, path); });
    } else if (const auto* table = std::get_if<ExportEvaluation>(&command)) {
      if (models.evaluation)
        write(table->path,
              [of = models.evaluation](const auto& path, Progress&) { return write_evaluation(*of, path); });
    } else if (const auto* plots = std::get_if<ExportPlots>(&command)) {
      if (models.evaluation) write_drawn(app.plots_picture({std::nullopt, 1800, 560, false}), plots->path);
    } else {
      return false;
    }
    return true;
  }
  /// Has a file written; `how` keeps what it is written from.
  template <class How>
  void write(const std::filesystem::path& path, How how) const {
    app.exports_.start(path, [path, how = std::move(how)](Progress& progress) { return how(path, progress); });
  }
  void write_drawn(Result<Picture> picture, const std::filesystem::path& path) const {
    if (!picture) return add_notice(state, picture.error().sentence());
    write(path, [picture = std::move(*picture)](const auto& to, Progress&) { return write_picture(picture, to); });
  }
};

void EditorApp::stop_playing() {
  state_.playing = false;
  if (state_.shown_frame) session_->apply(SetFrame{*state_.shown_frame});
  state_.shown_frame.reset();
}

void EditorApp::run_commands() {
  // Commands may send further ones. One that fails does not take the others with it.
  for (auto commands = out_.take(); !commands.empty(); commands = out_.take())
    for (const Command& command : commands) {
      const auto done = guarded("", [&]() -> Result<void> {
        std::visit(CommandRunner{*this}, command);
        return {};
      });
      if (!done) add_notice(state_, done.error().sentence());
    }
}

}  // namespace homolog
