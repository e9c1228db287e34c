#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/session/session.h"

namespace homolog {

/// The interface's knowledge of the session at one moment; immutable once handed out.
struct Snapshot {
  std::shared_ptr<const Document> document;  ///< the document as committed (and on disk)
  std::shared_ptr<const Document> shown;     ///< the running preview's document, else `document`
  std::optional<EditReport> preview;         ///< the running preview's report
  std::string preview_of;                    ///< the structure that it is about; empty: the first
  std::uint64_t revision = 0;                ///< counts every change of this struct
  std::uint64_t committed = 0;               ///< counts what was done or refused so far: actions, savings, syncs
  std::uint64_t steps_made = 0;              ///< the steps that this session made [EditSession::steps_made]
  std::uint64_t jobs_done = 0;               ///< counts what was posted and is done (or refused): edits and savings
  bool can_undo = false, can_redo = false;
  /// The steps that undo (redo) would take back (do again), the nearest step first; of a long history the nearest only.
  std::vector<std::string> undo_names, redo_names;
  double solver_ms = 0;        ///< time to compute the last job, from its arrival to the new points
  std::string message;         ///< the last edit's sentence; empty where there is none
  std::string error;           ///< the last action's refusal; empty after one that was done
  std::filesystem::path file;  ///< the journal's path; empty without one
  KeptWithCase kept;           ///< the things that the case keeps beside its steps
};

/// Refusals that a person must be told of, since somebody asked: edits may come and be refused faster than snapshots
/// are looked at.
struct Refusals {
  std::vector<std::string> news;  ///< the fate of the case's file [keep_case]
  std::string saved;              ///< the sentence that a saving was done
  std::size_t count = 0;          ///< the number of edits that were refused
  std::string first, last;        ///< sentences; `last` is empty where only one was refused
  bool unwritten = false;         ///< one of them was, since the case's file could not be written
};

/// Runs an EditSession on a thread of its own; with it the factorisation for drags is that thread's alone. The
/// interface posts jobs and looks at snapshots; it never waits. Previews are absolute and the latest wins; actions
/// queue and none is dropped.
class SessionThread {
 public:
  /// `wake` is called from the session's thread after every new snapshot.
  SessionThread(EditSession session, std::function<void()> wake);
  /// Finishes the queued actions, then joins.
  ~SessionThread();

  /// Shows what `action` and `then` would give (see EditSession::preview), until the next call. With no action and no
  /// `then` the preview ends.
  /// `of`: the structure that it is about; empty: the first. So with the others.
  void preview(std::optional<Action> action, std::vector<Compute> then = {}, std::string of = {});
  /// Commits an action; `joined` as EditSession::apply takes it. Ends previews, as apply_computed does: one that waits
  /// is dropped, one that is shown stays until the edit is done.
  void apply(Action action, bool joined = false, std::string of = {});
  /// Commits what `compute` makes of the document, once everything posted before is done. It runs on this thread, which
  /// takes no previews meanwhile. Does nothing where `compute` gives no action. If it is joined to an edit that ended a
  /// preview, the mesh that this showed is shown until it is done.
  void apply_computed(Compute compute, bool joined = false, std::string of = {});
  /// Looks after the case's file [EditSession::keep] and brings all edits to the disk. With `says_so`, Refusals::saved
  /// says where they are.
  void save(bool says_so);
  /// Says which label map is shown over the image, so that the case opens with it again [name_labels].
  void name_labels(std::filesystem::path labels);
  /// Continues the journal under another name (Save As): the whole history so far is written there first.
  void save_as(std::filesystem::path path);

  std::shared_ptr<const Snapshot> snapshot() const;
  /// The refusals since the last call. Called after snapshot(), it holds every refusal up to that snapshot.
  Refusals take_refusals();
  /// Whether an edit that was posted is not done (or refused) yet.
  bool busy() const { return snapshot()->jobs_done < posted_; }
  /// Waits until everything posted so far is done, and returns the session (for tests and for closing).
  EditSession finish();

 private:
  struct Shared;
  std::unique_ptr<Shared> shared_;
  std::uint64_t posted_ = 0;  ///< edits and savings
};

}  // namespace homolog
