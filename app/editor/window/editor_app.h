#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/editor/interface/drawing.h"
#include "app/editor/update/editing.h"
#include "app/editor/update/window_title.h"
#include "app/editor_options.h"

namespace homolog {

/// The editor without a window system: takes events, keeps the case's session and background work, and draws into the
/// framebuffer that is bound. The window and the pictures made without a display run the same one. Belongs to one
/// thread.
class EditorApp {
 public:
  /// `wake` may be called from any thread when there is something new to draw.
  explicit EditorApp(std::function<void()> wake);
  ~EditorApp();

  /// See Drawing; start_without_pictures() is for a window whose pictures nobody sees.
  Result<void> start_drawing(float scale) { return drawing_.start(scale); }
  void start_without_pictures(float scale) { drawing_.set_scale(scale); }
  void set_scale(float scale) { drawing_.set_scale(scale); }

  void start(const EditorOptions& options);
  /// Starts a case at once (no thread reads anything); its journal is the caller's matter.
  void start_session(EditSession session);
  void open(const std::vector<std::filesystem::path>& paths) { send(OpenFiles{paths}); }
  /// Does these one after the other, each when the one before it is done.
  void replay(std::vector<Command> commands);
  /// Done by the next update.
  void send(Command command) {
    do_held_click(state_, editing_.controls(), out_);
    out_.send(std::move(command));
  }

  void handle(const InputEvent& event);
  /// Takes in what the threads did, and moves what moves by itself. True where there is something new to draw.
  bool update(double seconds);
  /// Draws the window; ImGui's frame must not have begun.
  void draw(int width_px, int height_px, double frames_per_second) {
    drawing_.draw(width_px, height_px, frames_per_second);
  }
  /// Whether the next draw shows more than the last, without anything having happened.
  bool draws_on() const { return drawing_.draws_on(); }
  Result<Picture> picture(const PictureOptions& options) { return drawing_.picture(options); }

  /// For the frame that the system draws around the window.
  std::string title() const { return window_title(state_, shown_.snapshot(), work_); }
  /// Whether work beside the window goes on.
  bool busy() const { return work_.busy() || !to_replay_.empty(); }
  /// Whether everything that was asked for is done, and shown by the next frame.
  bool at_rest() const { return to_replay_.empty() && rests(); }
  /// Seconds until something moves by itself (a cine, a progress bar); nothing where only events change the picture.
  std::optional<double> next_move_seconds(double now) const;
  bool wants_to_quit() const { return state_.quitting == Quitting::now; }
  void ask_to_quit() { send(Quit{}); }

  /// Shows an edit as if it were dragged, and waits until it is shown.
  void preview(Action action);
  /// Waits for what is being opened and for the quality figures.
  void settle();

  const EditorState& state() const { return state_; }
  EditorState& state() { return state_; }
  const Snapshot& snapshot() const { return shown_.snapshot(); }
  const Layout& layout() const { return layout_; }
  CommandLog& log() { return log_; }

 private:
  /// Whether everything that was asked for so far is done, and its results are taken in.
  bool rests() const { return took_all_ && nothing_goes_on(); }
  bool nothing_goes_on() const {
    return !state_.pointer.held_click && !work_.busy() && !work_.models.has_to_write(state_.models) &&
           shown_.at_rest() && !work_.quality.busy() && !work_.measurements.busy() && !work_.scores.busy() &&
           out_.empty();
  }
  void run_commands();

  EditorState state_;
  Layout layout_;
  Outbox out_;
  CommandLog log_;
  std::deque<Command> to_replay_;
  bool took_all_ = false;  ///< nothing ran when results were taken in last, and no command was given since
  ShownCase shown_;
  Work work_;
  Drawing drawing_{state_, layout_, shown_, work_, out_};
  Editing editing_{state_, layout_, shown_, work_, drawing_, out_, log_};
};

}  // namespace homolog
