#include "core/session/session_thread.h"

#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <new>
#include <optional>
#include <thread>
#include <utility>
#include <variant>

#include "core/base/processes/guarded.h"
#include "core/session/case_file.h"
#include "core/session/case_keeping.h"
#include "core/session/unsaved_cases.h"

namespace homolog {

namespace {

/// The steps that a list of the history shows.
constexpr std::size_t most_names = 15;

}  // namespace

/// The two mailboxes, and the thread between them. Everything above the line is shared under `mutex`; everything below
/// belongs to the thread.
struct SessionThread::Shared {
  static constexpr auto touches_rest = std::chrono::milliseconds(100);
  struct SaveAs {
    std::filesystem::path path;
  };
  struct Save {
    bool says_so = false;
  };
  struct NameLabels {
    std::filesystem::path file;
  };
  struct Computed {
    Compute compute;
    bool joined = false;
    std::string of;
  };
  struct Preview {
    std::optional<Action> action;
    std::vector<Compute> then;
    std::string of;
  };
  /// A preview's document when an edit ended it, and of which structure.
  struct Previewed {
    std::shared_ptr<const Document> shown;
    std::string of;
  };
  using Job = std::variant<EditStep, Computed, SaveAs, Save, NameLabels>;

  mutable std::mutex mutex;
  std::condition_variable changed;
  std::deque<Job> jobs;                    ///< in: every one is done, in order
  std::optional<Preview> next_preview;     ///< in: the latest wins
  std::shared_ptr<const Snapshot> latest;  ///< out: the latest wins
  Refusals refusals;                       ///< out: until they are taken
  bool stopping = false;
  // ---
  EditSession session;
  std::shared_ptr<const Document> prepared;  ///< the document for whose next gesture all is ready
  std::string last_of;                       ///< the structure that was worked on last
  std::optional<Previewed> previewed;        ///< until the last edit, for what follows it
  std::function<void()> wake;
  std::thread thread;

  Shared(EditSession started, std::function<void()> woken) : session(std::move(started)), wake(std::move(woken)) {
    Snapshot first;
    describe(first);
    first.shown = first.document;
    latest = std::make_shared<const Snapshot>(std::move(first));
  }

  void describe(Snapshot& snapshot) {
    snapshot.document = session.shared_document();
    snapshot.steps_made = session.steps_made();
    snapshot.can_undo = session.can_undo();
    snapshot.can_redo = session.can_redo();
    snapshot.undo_names = session.undo_names(most_names);
    snapshot.redo_names = session.redo_names(most_names);
    snapshot.kept = session.kept();
    snapshot.file = session.journal() != nullptr ? session.journal()->path() : std::filesystem::path();
  }

  /// `error`: of a job, why it was refused, empty where it was done; nothing where none ended.
  void publish(Snapshot snapshot, std::optional<std::string> error = {}) {
    ++snapshot.revision;
    if (error) snapshot.error = *error;
    const std::string file = session.journal() != nullptr ? session.journal()->path().string() : std::string();
    const bool of_file = error && !file.empty() && error->starts_with(printable(file));
    auto next = std::make_shared<const Snapshot>(std::move(snapshot));
    pass_on_news();
    {
      const std::lock_guard lock(mutex);  // nothing fails from here on, so that no refusal is counted twice
      latest = std::move(next);
      if (error && !error->empty()) {
        refusals.unwritten = refusals.unwritten || of_file;
        (refusals.count++ == 0 ? refusals.first : refusals.last) = std::move(*error);
      }
    }
    if (wake) wake();
  }

  void pass_on_news() {
    if (session.news().empty()) return;
    const std::lock_guard lock(mutex);
    refusals.news.push_back(session.news());
    session.forget_news();
  }

  /// Every edit ends so, whether it was done, refused or nothing: what was previewed is over.
  void end_edit(Snapshot& snapshot) {
    describe(snapshot);
    snapshot.shown = snapshot.document;
    snapshot.preview.reset();
    ++snapshot.committed;
    ++snapshot.jobs_done;
  }

  /// `computed`: a person previewed nothing of it.
  void do_action(EditStep step, bool computed = false) {
    if (std::holds_alternative<Note>(step.action)) return do_note(std::move(step));
    Snapshot snapshot = *latest;
    previewed.reset();
    auto report = session.apply(std::move(step));
    if (report && snapshot.preview && !computed) previewed = {snapshot.shown, snapshot.preview_of};
    end_edit(snapshot);
    if (report) {
      snapshot.message = report->message;
      snapshot.solver_ms = report->solver_ms;
    }
    publish(std::move(snapshot), report ? "" : report.error().sentence());
  }

  /// A note is no edit: what is previewed goes on, and what the last edit said stays.
  void do_note(EditStep step) {
    Snapshot snapshot = *latest;
    const auto report = session.apply(std::move(step));
    describe(snapshot);
    ++snapshot.jobs_done;
    if (report) return publish(std::move(snapshot));
    ++snapshot.committed;
    publish(std::move(snapshot), report.error().sentence());
  }

  /// The mesh that a preview showed until the edit that ended it stays on the screen while what follows it is computed.
  void show_again(const Previewed& before, const std::string& of) {
    const auto was = before.shown->view(before.of), is = session.document().view(of);
    if (!was || !is || was->structure.id != is->structure.id || was->frame != is->frame ||
        was->shape.points->rows() != is->shape.points->rows())
      return;
    auto updated = session.preview(SetPoints{FoundBy::fit, std::nullopt, was->shape.points}, {}, of);
    if (!updated) return;
    Snapshot snapshot = *latest;
    snapshot.shown = std::make_shared<const Document>(std::move(updated->document));
    snapshot.preview = std::move(updated->report);
    snapshot.preview_of = of;
    publish(std::move(snapshot));
  }

  void do_computed(const Computed& computed) {
    const auto before = std::exchange(previewed, std::nullopt);
    if (before && computed.joined) show_again(*before, computed.of);
    auto action = computed.compute(session.document(), computed.of);
    if (action && *action) return do_action({std::move(**action), computed.of, computed.joined}, true);
    Snapshot snapshot = *latest;
    end_edit(snapshot);
    publish(std::move(snapshot), action ? "" : action.error().sentence());
  }

  void do_save_as(const std::filesystem::path& path) {
    Snapshot snapshot = *latest;
    auto saved = save_case_as(session, path);
    describe(snapshot);
    ++snapshot.committed;
    ++snapshot.jobs_done;
    const bool kept_only = path.parent_path() == unsaved_folder();  // nobody asked for it
    if (saved) snapshot.message = kept_only ? "Kept until you save it." : "Saved as " + path.string();
    publish(std::move(snapshot), saved ? "" : saved.error().sentence());
  }

  void do_save(Save save) {
    session.keep();
    const Journal* journal = session.journal();
    Snapshot snapshot = *latest;
    const auto synced = journal != nullptr ? session.journal()->sync() : Result<void>();
    describe(snapshot);
    ++snapshot.committed;
    ++snapshot.jobs_done;
    if (save.says_so && synced && journal != nullptr && journal->path().parent_path() != unsaved_folder()) {
      const std::lock_guard lock(mutex);
      refusals.saved = "Saved: every edit is in " + journal->path().string();
    }
    publish(std::move(snapshot), synced ? "" : synced.error().sentence());
  }

  void do_name_labels(const std::filesystem::path& file) {
    Snapshot snapshot = *latest;
    const auto named = homolog::name_labels(session, file);
    describe(snapshot);
    ++snapshot.jobs_done;
    publish(std::move(snapshot), named ? "" : named.error().sentence());
  }

  void do_sync() {
    const auto synced = session.sync();
    if (synced) return;
    Snapshot snapshot = *latest;
    ++snapshot.committed;
    publish(std::move(snapshot), synced.error().sentence());
  }

  void prepare() {
    prepared = session.shared_document();
    session.prepare(last_of);
  }

  void show_preview(const Preview& preview) {
    Snapshot snapshot = *latest;
    previewed.reset();
    snapshot.message.clear();  // the last edit's is old by now; the preview has one of its own
    if (preview.action || !preview.then.empty()) {
      last_of = preview.of;
      auto updated = session.preview(preview.action, preview.then, preview.of);
      if (!updated) {
        snapshot.message = updated.error().sentence();
      } else {
        snapshot.shown = std::make_shared<const Document>(std::move(updated->document));
        snapshot.solver_ms = updated->report.solver_ms;
        snapshot.preview = std::move(updated->report);
        snapshot.preview_of = preview.of;
      }
    } else {
      snapshot.shown = snapshot.document;
      snapshot.preview.reset();
    }
    publish(std::move(snapshot));
  }

  /// Says why a job came to nothing: what is thrown ends neither the thread nor the program. The session is as before,
  /// or, where only showing what was done failed, as the disk says; either way it is shown so.
  void tell(const std::exception_ptr& thrown, bool was_job) {
    Snapshot snapshot = *latest;
    const bool done = session.shared_document() != snapshot.document;
    end_edit(snapshot);
    if (!was_job) {
      --snapshot.committed;
      --snapshot.jobs_done;
    }
    std::string error;
    try {
      std::rethrow_exception(thrown);
    } catch (const std::bad_alloc&) {
      error = done ? "Memory is almost used up. This edit was done, but the next one may fail; close other programs."
                   : error_of_exception("The edit").sentence();
    } catch (...) {
      error = error_of_exception("The edit").sentence();
    }
    publish(std::move(snapshot), std::move(error));
  }

  /// Until there is memory enough to say it.
  void tell_in_the_end(const std::exception_ptr& thrown, bool was_job) {
    constexpr auto a_while = std::chrono::milliseconds(50);
    for (bool told = false; !told;) {
      try {
        tell(thrown, was_job);
        told = true;
      } catch (const std::bad_alloc&) {
        std::this_thread::sleep_for(a_while);
        const std::lock_guard lock(mutex);
        if (stopping) return;
      }
    }
  }

  void run() {
    for (;;) {
      std::optional<Job> job;
      std::optional<Preview> preview;
      bool rests = false, is_idle = false;
      {
        std::unique_lock lock(mutex);
        const auto comes = [&] { return stopping || !jobs.empty() || next_preview; };
        if (session.unsynced() || prepared != session.shared_document())
          rests = !changed.wait_for(lock, touches_rest, comes);
        else
          changed.wait(lock, comes);
        if (rests) {
          // A brush stroke is over: its touches go to the disk together. Then the next gesture is prepared.
          is_idle = true;
        } else if (!jobs.empty()) {
          job = std::move(jobs.front());
          jobs.pop_front();
        } else if (next_preview) {
          preview = std::exchange(next_preview, std::nullopt);
        } else if (session.unsynced()) {
          rests = true;  // stopping: where the disk fails, it can still be told
        } else {
          return;  // stopping, and nothing is left to do
        }
      }
      try {
        if (job && std::holds_alternative<EditStep>(*job)) do_action(std::get<EditStep>(std::move(*job)));
        if (job && std::holds_alternative<SaveAs>(*job)) do_save_as(std::get<SaveAs>(*job).path);
        if (job && std::holds_alternative<Save>(*job)) do_save(std::get<Save>(*job));
        if (job && std::holds_alternative<NameLabels>(*job)) do_name_labels(std::get<NameLabels>(*job).file);
        if (job && std::holds_alternative<Computed>(*job)) do_computed(std::get<Computed>(*job));
        if (preview) show_preview(*preview);
        if (rests) do_sync();
        if (is_idle) prepare();
      } catch (...) {
        tell_in_the_end(std::current_exception(), job.has_value());
      }
    }
  }

  /// Edits must not go with a file that another program took away.
  void end() {
    try {
      if (session.edited()) session.keep();
      pass_on_news();
    } catch (const std::bad_alloc&) {
    }
  }

  void post(Job job) {
    {
      const std::lock_guard lock(mutex);
      jobs.push_back(std::move(job));
    }
    changed.notify_one();
  }

  void post_edit(Job job) {
    {
      const std::lock_guard lock(mutex);
      const auto* step = std::get_if<EditStep>(&job);
      const bool is_note = step != nullptr && std::holds_alternative<Note>(step->action);
      if (!is_note) next_preview.reset();  // it belonged to the gesture that this edit ends
      jobs.push_back(std::move(job));
    }
    changed.notify_one();
  }

  void stop() {
    {
      const std::lock_guard lock(mutex);
      stopping = true;
      next_preview.reset();
    }
    changed.notify_one();
    if (thread.joinable()) thread.join();
  }
};

SessionThread::SessionThread(EditSession session, std::function<void()> wake)
    : shared_(std::make_unique<Shared>(std::move(session), std::move(wake))) {
  shared_->thread = std::thread([shared = shared_.get()] {
    shared->run();
    shared->end();
  });
}

SessionThread::~SessionThread() {
  if (shared_) shared_->stop();
}

void SessionThread::preview(std::optional<Action> action, std::vector<Compute> then, std::string of) {
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->next_preview = Shared::Preview{std::move(action), std::move(then), std::move(of)};
  }
  shared_->changed.notify_one();
}

void SessionThread::apply(Action action, bool joined, std::string of) {
  ++posted_;
  shared_->post_edit(EditStep{std::move(action), std::move(of), joined});
}

void SessionThread::apply_computed(Compute compute, bool joined, std::string of) {
  ++posted_;
  shared_->post_edit(Shared::Computed{std::move(compute), joined, std::move(of)});
}

void SessionThread::save(bool says_so) {
  ++posted_;
  shared_->post(Shared::Save{says_so});
}

void SessionThread::name_labels(std::filesystem::path labels) {
  ++posted_;
  shared_->post(Shared::NameLabels{std::move(labels)});
}

void SessionThread::save_as(std::filesystem::path path) {
  ++posted_;
  shared_->post(Shared::SaveAs{std::move(path)});
}

std::shared_ptr<const Snapshot> SessionThread::snapshot() const {
  const std::lock_guard lock(shared_->mutex);
  return shared_->latest;
}

Refusals SessionThread::take_refusals() {
  const std::lock_guard lock(shared_->mutex);
  return std::exchange(shared_->refusals, {});
}

EditSession SessionThread::finish() {
  shared_->stop();
  return std::move(shared_->session);
}

}  // namespace homolog
