#include "app/editor/editor_app.h"

#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <cstdio>

#include "app/editor/widgets/plots.h"
#include "app/editor/window/view_overlay.h"
#include "core/case/unsaved_cases.h"

namespace homolog {

namespace {

bool has_region(const Document& document, const std::string& name) {
  return document.regions && std::any_of(document.regions->list.begin(), document.regions->list.end(),
                                         [&](const Region& region) { return region.name == name; });
}

}  // namespace

bool has_unsaved_edits(const Snapshot& snapshot) {
  if (snapshot.file.empty()) return snapshot.can_undo && snapshot.committed > 0;
  return snapshot.can_undo && snapshot.file.parent_path() == unsaved_folder();
}

EditorApp::EditorApp(std::function<void()> wake)
    : wake_(std::move(wake)), opener_(wake_), quality_(wake_), template_maker_(wake_) {}

EditorApp::~EditorApp() {
  for (const std::string& sentence : models_.close(state_.models))
    std::fprintf(stderr, "homolog: warning: %s\n", sentence.c_str());
  close_session();
}

Result<void> EditorApp::start_drawing(float scale) {
  auto pictures = ViewPictures::make();
  if (!pictures) return fail(pictures.error());
  pictures_ = std::move(*pictures);
  set_scale(scale);
  return {};
}

void EditorApp::set_scale(float scale) {
  scale_ = scale;
  const bool had_texture = pictures_ && theme_;
  if (had_texture) ImGui_ImplOpenGL3_DestroyFontsTexture();
  theme_ = make_theme(scale);
  // ImGui makes the first texture by itself, and only that one.
  if (had_texture) ImGui_ImplOpenGL3_CreateFontsTexture();
}

void EditorApp::start(const EditorOptions& options) {
  offer_ = Offer::dialog;
  recovery_.look();
  start_session(EditSession(new_document({}, nullptr, nullptr)));
  if (options.demo) {
    out_.send(OpenPhantom{*options.demo, 1});
  } else if (!options.files.empty() || !options.template_source.empty()) {
    auto request = sort_files(options.files);
    if (!request) return add_notice(state_, request.error().sentence());
    if (!options.template_source.empty()) request->template_source = options.template_source;
    opener_.start(std::move(*request));
    offer_ = Offer::notice;
  } else {
    out_.send(OpenPhantom{Organ::kidney, 1});
  }
}

void EditorApp::open(const std::vector<std::filesystem::path>& paths) {
  out_.send(OpenFiles{paths});
}

void EditorApp::close_session() {
  if (!session_) return;
  snaps_.cancel();
  session_.reset();  // what was asked for is done, and the journal closed
  remove_without_edits(snapshot_->file);
}

void EditorApp::start_session(EditSession session) {
  close_session();
  const auto volume_before = displayed_ ? displayed_->volume : nullptr;
  const std::string source_before = volume_before ? displayed_->volume_source : std::string();
  loaded_template_ = session.initial_document().reference;
  session_ = std::make_unique<SessionThread>(std::move(session), wake_);
  ++session_number_;
  snapshot_ = session_->snapshot();
  displayed_ = snapshot_->shown;
  show_document(state_, *displayed_, layout_, !source_before.empty() && displayed_->volume_source == source_before);
  fit_wanted_ = layout_.scale <= 0 || layout_.status_line.width <= 0 || layout_.models.width > 0;
  if (!fit_wanted_) show_repair();
  remember_case();
  if (displayed_->volume != volume_before) {
    labels_.reset();
    if (pictures_) pictures_->forget();
  }
  quality_.post(nullptr);
  quality_.post(displayed_);
}

void EditorApp::show_repair() {
  if (const auto frame = Models::show_repair(state_, *snapshot_)) session_->apply(SetFrame{*frame});
}

ControlsContext EditorApp::controls_context() const {
  return {layout_, *displayed_, snapshot_->can_undo, snapshot_->can_redo};
}

void EditorApp::handle(const InputEvent& event) {
  const auto handled = guarded("", [&]() -> Result<void> {
    handle_event(state_, event, controls_context(), out_);
    return {};
  });
  if (!handled) add_notice(state_, handled.error().sentence());
}

bool EditorApp::busy() const {
  return opener_.busy() || work_.busy() || exports_.busy() || template_maker_.busy() || fitter_.busy() ||
         study_appearance_.busy() || models_.busy() || snaps_.busy();
}

std::optional<double> EditorApp::next_move_seconds(double now) const {
  constexpr double progress_seconds = 0.1;
  if (state_.playing) return std::max(frame_due_ - now, 0.0);
  if (thumbnails_left_) return 0;
  if (busy()) return progress_seconds;
  auto next = models_.next_move_seconds(state_.models);
  if (const auto rest = quality_.rest_seconds()) next = std::min(next.value_or(*rest), *rest);
  for (const Notice& notice : state_.notices)
    if (notice.until) next = std::min(next.value_or(*notice.until - now), std::max(*notice.until - now, 0.0));
  return next;
}

bool EditorApp::at_rest() const {
  return !busy() && !session_->busy() && snapshot_ == session_->snapshot() && !quality_.busy() && out_.empty();
}

void EditorApp::remember_case() {
  const auto& file = snapshot_->file;
  if (!file.empty() && file.parent_path() != unsaved_folder()) remember_recent(state_.preferences, file);
}

void EditorApp::take_snapshot() {
  const auto latest = session_->snapshot();
  const bool changed = latest != snapshot_, done = latest->committed != snapshot_->committed;
  const bool renamed = latest->file != snapshot_->file;
  // The brush lets go of a region that was taken back.
  const std::string& brushed = state_.brush.region;
  if (has_region(*snapshot_->document, brushed) && !has_region(*latest->document, brushed)) state_.brush.region.clear();
  if (state_.renaming && !has_region(*latest->document, state_.renaming->rename.name)) state_.renaming.reset();
  snapshot_ = latest;
  if (renamed) remember_case();
  keep_on_disk();
  if (done && !snapshot_->error.empty()) add_notice(state_, snapshot_->error);
  const int frame = shown_frame(state_, *snapshot_->shown);
  const bool other_frame = displayed_->frame != frame;
  if (!changed && !other_frame) return;
  const auto before = displayed_;
  displayed_ = snapshot_->shown;
  if (frame != displayed_->frame) {
    auto at_frame = std::make_shared<Document>(*displayed_);
    at_frame->frame = frame;
    displayed_ = std::move(at_frame);
  }
  const bool moved = before->has_shape() != displayed_->has_shape() ||
                     (displayed_->has_shape() && before->shape().points != displayed_->shape().points);
  if (moved) quality_.post(displayed_);
}

void EditorApp::keep_on_disk() {
  // The state folder was full, or the case is read-only: tried again with every edit.
  if (!snapshot_->file.empty() || !has_unsaved_edits(*snapshot_) || tried_to_keep_ == snapshot_->document) return;
  tried_to_keep_ = snapshot_->document;
  if (auto path = new_unsaved_path())
    session_->save_as(std::move(*path));
  else
    add_notice(state_, path.error().sentence());
}

/// News go by themselves, errors stay until they are dismissed.
void EditorApp::forget_old_news(double seconds) {
  constexpr double news_seconds = 8;
  for (Notice& notice : state_.notices)
    if (!notice.error && !notice.until) notice.until = seconds + news_seconds;
  std::erase_if(state_.notices, [&](const Notice& notice) { return notice.until && *notice.until <= seconds; });
}

bool EditorApp::update(double seconds) {
  bool changed = true;
  const auto done = guarded("", [&]() -> Result<void> {
    changed = update_parts(seconds);
    return {};
  });
  if (!done) add_notice(state_, done.error().sentence());
  return changed;
}

bool EditorApp::update_parts(double seconds) {
  const std::size_t notices_before = state_.notices.size();
  const auto before = snapshot_;
  const bool was_busy = busy();
  run_commands();
  if (auto opened = opener_.take()) {
    if (*opened)
      take_opened(std::move(**opened));
    else
      add_notice(state_, opened->error().sentence());
  }
  take_work();
  if (state_.playing && seconds >= frame_due_ && displayed_->volume && displayed_->volume->frames > 1) {
    const Volume& volume = *displayed_->volume;
    const double pace = volume.frame_seconds > 0 ? volume.frame_seconds : 0.05;
    frame_due_ = std::max(frame_due_ + pace, seconds);
    state_.shown_frame = (shown_frame(state_, *displayed_) + 1) % volume.frames;
  }
  take_snapshot();
  const bool new_files = take_written();
  follow_fit();
  follow_model_help();
  follow_learning();
  const bool new_snap = take_snap();
  const bool new_model = models_.update(state_, *snapshot_, seconds, out_);
  follow_quit();
  const bool new_figures = quality_.update();
  const bool new_stage = take_stage();
  const bool new_offer = take_recovery();
  forget_old_news(seconds);
  return state_.notices.size() != notices_before || before != snapshot_ || new_figures || new_stage || new_model ||
         new_snap || new_offer || new_files || thumbnails_left_ || state_.playing || was_busy || busy();
}

void EditorApp::preview(Action action) {
  const auto before = session_->snapshot();
  session_->preview(std::move(action));
  while (session_->snapshot() == before) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

void EditorApp::settle() {
  run_commands();
  opener_.finish();
  work_.finish();
  update_parts(0);
  models_.settle(state_, *snapshot_, out_);
  exports_.finish();
  take_written();
  quality_.finish();
  while (recovery_.busy()) {
    recovery_.finish();
    take_recovery();
  }
}

bool EditorApp::take_work() {
  bool any = false;
  while (auto done = work_.take()) {
    any = true;
    if (*done)
      (**done)();
    else
      add_notice(state_, done->error().sentence());
  }
  return any;
}

bool EditorApp::take_written() {
  const auto written = exports_.take();
  for (const auto& [path, result, cancelled, then] : written) {
    add_notice(state_, result ? "Written: " + path.string() : result.error().sentence(), !result && !cancelled);
    if (!result)
      quit_when_written_ = false;
    else if (then)
      then();
  }
  return !written.empty();
}

void EditorApp::quit_when_written(bool without_study) {
  quit_when_written_ = true;
  quit_without_study_ = without_study;
  if (!without_study) models_.write_if_changed(state_.models);
  if (const auto file = exports_.running()) {
    const std::string name = std::filesystem::path(file->subject).filename().string();
    add_notice(state_, "Homolog closes as soon as " + name + " is written.", false);
  }
  follow_quit();
}

void EditorApp::follow_quit() {
  if (!quit_when_written_ || exports_.busy()) return;
  if (!quit_without_study_) {
    if (models_.files_running()) return;
    models_.take_files(state_, out_);
    if (!models_.unwritten().empty()) {
      quit_when_written_ = false;
      state_.dialog = QuitDialog{models_.unwritten()};
      return;
    }
    if (models_.write_if_changed(state_.models)) return;  // it was changed meanwhile
  }
  quit_ = true;
}

bool EditorApp::take_snap() {
  if (auto found = snaps_.take()) {
    if (!found->warning.empty()) add_notice(state_, found->warning, false);
    state_.snapped = std::move(found);
  }
  const bool shown = state_.snapped && displayed_->has_shape() && state_.snapped->is_of(*displayed_->shape().points);
  auto confidence = shown ? state_.snapped->confidence : nullptr;
  const bool changed = confidence != state_.confidence;
  state_.confidence = std::move(confidence);
  return changed;
}

bool EditorApp::take_stage() {
  template_maker_.update();
  const auto making = template_maker_.latest();
  if (making == seen_making_) return template_maker_.busy();
  const bool first = making_shown_ && making && making->stages.size() == 1 && !making->done;
  seen_making_ = making;
  if (first) look_at_mesh(state_, making->stages.front().surface->points);
  return true;
}

std::shared_ptr<const Mesh> EditorApp::shown_making() const {
  const auto making = making_shown_ ? template_maker_.latest() : nullptr;
  if (!making || making->stages.empty()) return nullptr;
  return making->stages[std::min(state_.shown_stage.value_or(making->stages.size()), making->stages.size() - 1)]
      .surface;
}

SceneBuilder::Input EditorApp::scene_input(const EditorState& state) const {
  return {state, displayed_, snapshot_->preview, labels_, shown_making()};
}

std::vector<RunningWork> EditorApp::running_work() const {
  constexpr double shown_after_seconds = 0.5;
  std::vector<RunningWork> running;
  const auto show = [&](const char* kind, const std::string& verb, const std::optional<RunningJob>& job, Command cancel,
                        const char* tip) {
    if (job && job->seconds > shown_after_seconds)
      running.push_back({kind,
                         verb + std::filesystem::path(job->subject).filename().string(),
                         tip,
                         std::move(cancel),
                         job->fraction,
                         {}});
  };
  show("opening", "Opening ", opener_.running(), CancelOpening{}, "What is open stays as it is");
  show("reading", "Reading ", work_.running(), CancelReading{}, "The case stays as it is");
  if (const auto job = models_.files_running(); job && job->seconds > shown_after_seconds)
    running.push_back(study_work(*job));
  if (const auto file = exports_.running())
    show("writing", "Writing ", file, CancelWriting{file->subject},
         "Nothing is written, and what the file held before stays");
  return running;
}

UiContext EditorApp::ui_context(const EditorState& state, double fps) const {
  return {*theme_,
          layout_,
          state,
          *snapshot_,
          displayed_,
          quality_,
          running_work(),
          labels_,
          labels_name_,
          label_values_,
          template_maker_,
          fitter_,
          study_appearance_,
          thumbnails_,
          snaps_.busy(),
          shown_making() != nullptr,
          fps};
}

}  // namespace homolog
