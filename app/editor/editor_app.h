#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "app/editor/editor.h"
#include "app/editor/panels/ui_context.h"
#include "app/editor/scene/scene_builder.h"
#include "app/editor/scene/view_pictures.h"
#include "app/editor/update/controls.h"
#include "app/editor/update/models.h"
#include "app/editor/work/exports.h"
#include "app/editor/work/model_help.h"
#include "app/editor/work/opener.h"
#include "app/editor/work/quality_monitor.h"
#include "app/editor/work/recovery.h"
#include "app/editor/work/study_appearance.h"
#include "app/editor/work/worker.h"

namespace homolog {

/// Whether there are edits of a case that has no file of its own.
bool has_unsaved_edits(const Snapshot& snapshot);

/// The editor without a window system: takes events, keeps the case's session and background work, and draws into the
/// framebuffer that is bound. The window and the pictures made without a display run the same one.
class EditorApp {
 public:
  /// `wake` may be called from any thread when there is something new to draw.
  explicit EditorApp(std::function<void()> wake);
  ~EditorApp();

  /// Needs a current OpenGL context and ImGui's; both must outlive the drawing calls.
  Result<void> start_drawing(float scale);
  /// Instead of that, for a window whose pictures nobody sees: lays out the interface, and draws nothing. Needs ImGui's
  /// context alone.
  void start_without_pictures(float scale) { set_scale(scale); }
  /// Starts a case at once (no thread reads anything); its journal is the caller's matter.
  void start_session(EditSession session);
  void start(const EditorOptions& options);
  void open(const std::vector<std::filesystem::path>& paths);
  /// Done by the next update.
  void send(Command command) { out_.send(std::move(command)); }

  void handle(const InputEvent& event);
  /// Takes in what the threads did, and moves what moves by itself. True where there is something new to draw.
  bool update(double seconds);
  /// Whether work beside the window goes on.
  bool busy() const;
  /// Whether everything that was asked for is done, and shown by the next frame.
  bool at_rest() const;
  /// Draws the window; ImGui's frame must not have begun. `fps` is shown.
  void draw(int width_px, int height_px, double frames_per_second);
  /// Whether the next draw shows more than the last, without anything having happened.
  bool draws_on() const { return thumbnails_left_; }
  /// Sets the scale of the interface; the next draw uses it.
  void set_scale(float scale);

  const EditorState& state() const { return state_; }
  EditorState& state() { return state_; }
  bool wants_to_quit() const { return quit_; }
  /// Seconds until something moves by itself (a cine, a progress bar); nothing where only events change the picture.
  std::optional<double> next_move_seconds(double now) const;
  void ask_to_quit() { out_.send(Quit{}); }
  /// Shows an edit as if it were dragged, and waits until it is shown.
  void preview(Action action);
  /// Waits for what is being opened and for the quality figures.
  void settle();
  const Snapshot& snapshot() const { return *snapshot_; }
  const Layout& layout() const { return layout_; }

 private:
  friend struct CommandRunner;
  ControlsContext controls_context() const;
  void close_session();
  void stop_playing();
  void take_snapshot();
  /// Puts the case's file among the recent ones.
  void remember_case();
  /// Shows how far the fit (or refinement) is, and takes it in when it is done; gives it up where the case was edited
  /// meanwhile.
  void follow_fit();
  void take_fit(Fitted fitted);
  void cancel_fit();
  /// What carries on from an edit while it is previewed.
  std::vector<Compute> assistance(const Action& action) const;
  void ask_model();
  /// Shows, or commits, the shape with as much of the study's model in it; once that is computed, where it is not yet.
  void blend_model(const BlendModel& command);
  void follow_model_help();
  /// Learns what the boundary looks like from the study's cases that are done, where snaps are to go by that.
  void follow_learning();
  /// Goes to the place that the case was opened for, where it was for one.
  void show_repair();
  bool update_parts(double seconds);
  void take_opened(Opened opened);
  /// Shows the label map that was opened over the image.
  void take_labels(const Opened& opened);
  /// What became of the work that leaves something to do here.
  bool take_work();
  /// Reads a file beside the window with `read`, and hands what it gives to `take`, where the case is still the same.
  template <class Read, class Take>
  void read_for_case(const std::filesystem::path& path, Read read, Take take);
  void import_landmarks(const std::filesystem::path& path);
  void import_stiffness(const std::filesystem::path& path);
  void import_template_landmarks(const std::filesystem::path& path);
  void use_made_template(const std::filesystem::path& path);
  void draw_pictures(int width_px, int height_px);
  void start_document(Document document);
  void run_commands();
  void offer_flip(const Document& document);
  /// Offers the cases that were found; true where there is something new to draw.
  bool take_recovery();
  /// Gives a case without a journal one, where edits are not on the disk yet.
  void keep_on_disk();
  void forget_old_news(double seconds);
  /// Takes in what a snap found; true where there is something new to draw.
  bool take_snap();
  /// Takes in what the template maker has; true where there is something new to draw.
  bool take_stage();
  /// The stage of the template in the making that is shown; null: the case's mesh is.
  std::shared_ptr<const Mesh> shown_making() const;
  SceneBuilder::Input scene_input(const EditorState& state) const;
  /// Says which files were written; true where there were some.
  bool take_written();
  /// Closes the window as soon as all files are written; `without_study`: the study's too, or not.
  void quit_when_written(bool without_study);
  /// Does so now where nothing is left to write; asks where the study's file could not be written.
  void follow_quit();
  /// The window or one view in another size.
  Result<Picture> picture(const PictureOptions& options);
  /// Into the framebuffer that is bound, and the layout of that.
  void draw_view_picture(const PictureOptions& options);
  /// The plots of the model's measures, 3 side by side.
  Result<Picture> plots_picture(const PictureOptions& options);
  std::vector<RunningWork> running_work() const;
  UiContext ui_context(const EditorState& state, double fps) const;

  std::function<void()> wake_;
  EditorState state_;
  Models models_{wake_};
  GalleryPictures gallery_;
  StudyAppearance study_appearance_{wake_};
  Fitter fitter_{wake_};
  bool fit_seen_ = false;  ///< a step of the fit that goes on was shown
  ModelHelp model_help_{wake_};
  std::optional<BlendModel> blend_wanted_;  ///< as soon as the model's part is computed
  CaseThumbnails thumbnails_;
  bool thumbnails_left_ = false;  ///< some are drawn in the next frame
  Outbox out_;
  Layout layout_;
  float scale_ = 1;
  std::unique_ptr<SessionThread> session_;
  std::uint64_t session_number_ = 0;  ///< counts the cases that were on the screen
  std::shared_ptr<const Snapshot> snapshot_;
  std::shared_ptr<const Document> tried_to_keep_;  ///< the last for which a journal was asked
  std::shared_ptr<const Document> displayed_;
  std::shared_ptr<const Template> loaded_template_;  ///< as its file holds it: the case may have mirrored it
  Recovery recovery_{wake_};
  /// How cases that were found are offered: at a start without files, with some, and when somebody asks.
  enum class Offer { dialog, notice, asked } offer_ = Offer::dialog;
  Opener opener_;
  Exports exports_{wake_};
  /// What is to be done here when the work is done.
  using Then = std::function<void()>;
  Worker<Then> work_{wake_};
  QualityMonitor quality_;
  std::shared_ptr<const Volume> labels_;
  std::string labels_name_;
  std::vector<int> label_values_;
  Snaps snaps_;
  TemplateMaker template_maker_;
  std::shared_ptr<const TemplateMaking> seen_making_;
  bool making_shown_ = false;  ///< the template that is being made stands in for the case's mesh
  SceneBuilder scenes_;
  std::optional<ViewPictures> pictures_;
  std::optional<Theme> theme_;
  double frame_due_ = 0;
  bool fit_wanted_ = true;
  bool quit_ = false, quit_when_written_ = false, quit_without_study_ = false;
};

}  // namespace homolog
