#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/case/action.h"
#include "core/session/case_lines.h"
#include "core/session/case_templates.h"
#include "core/session/history.h"
#include "core/session/line_kind.h"

namespace homolog {

/// Something that is computed from the document (a snap, the model's help) and becomes an action; none where there is
/// nothing to do. `of`: the structure that it is about; empty: the first.
using Compute = std::function<Result<std::optional<Action>>(const Document&, const std::string& of)>;

/// The limits of a session's history.
struct HistoryLimits {
  std::size_t bytes = std::size_t{192} << 20;  ///< room for states kept in memory
  /// At most so many steps are played again to come to a state: a checkpoint is written to the file where more would
  /// be. 0: what takes about half a second with this mesh.
  std::size_t replayed_steps = 0;
};

/// Things that a case keeps beside its steps, so that no undo takes them back: what its notes said last.
struct KeptWithCase {
  std::optional<std::array<double, 2>> window;  ///< the image's values that are shown black and white
  std::filesystem::path template_file;  ///< the file that holds the template as it is painted; empty: it was not saved
  std::optional<FitFigures> fit;        ///< the last fit to a label map
  std::shared_ptr<const KeptLooks> looks;     ///< the structures' looks; null: as at first
  std::shared_ptr<const KeptMapFit> map_fit;  ///< the last fit of a set to a label map; null: there was none
  std::filesystem::path labels;               ///< the label map over the image, of the first line; empty: none
  std::string record;  ///< how a verb made it, for the first line of a new case [file_record.h]; empty: none did
};

/// A case being edited: the document, its history and its journal. Belongs to one thread.
/// An action is computed, then written to the journal and synced, then shown as done; apply() says what is synced
/// later.
class EditSession {
 public:
  explicit EditSession(Document document, const HistoryLimits& limits = {});

  const Document& document() const { return *document_; }
  std::shared_ptr<const Document> shared_document() const { return document_; }
  /// Moves the placement that a case starts from; nothing has been done yet.
  Result<void> start_at(const Similarity& placement);
  /// Applies an action (Undo and Redo too). `joined`: see EditStep; an action begins a step of its own all the same
  /// where the one before it was refused, taken back, or a look at a frame. Computed points are rounded
  /// [moved_points.h]. A joined action or a look is written at once but synced only with what follows, or by sync().
  /// On error nothing has changed, in memory or on disk; where memory runs out (std::bad_alloc) neither. Before it
  /// comes keep().
  /// `of`: the structure that it works on; empty: the first.
  Result<EditReport> apply(Action action, bool joined = false, std::string of = {});
  Result<EditReport> apply(EditStep step);
  /// The result that the action would give, without doing it. Cheap during a drag, because the gesture is cached.
  /// Without an action it starts from the document. Each of `then` carries on from the result before it; a refusal
  /// becomes a message.
  Result<Updated> preview(const std::optional<Action>& action, const std::vector<Compute>& then = {},
                          const std::string& of = {});

  /// Factorises ahead for a structure (as `of` above), so that its next gesture begins at once. Changes nothing else.
  void prepare(const std::string& of = {});

  bool can_undo() const { return history_.undo().has_value(); }
  bool can_redo() const { return history_.redo().has_value(); }
  /// Name of what undo (redo) would take back (do again) [step_name.h]; empty where there is nothing.
  std::string undo_name() { return name(history_.undo()); }
  std::string redo_name() { return name(history_.redo()); }
  /// The same of at most `most` steps back (on), the nearest first.
  std::vector<std::string> undo_names(std::size_t most);
  std::vector<std::string> redo_names(std::size_t most);

  const Document& initial_document() const { return history_.start(); }
  int strokes() const;  ///< those left after undo
  /// Steps that apply() made; those that were undone count too, and what is joined counts as one.
  std::uint64_t steps_made() const { return steps_made_; }
  int solves() const { return solves_; }
  const KeptWithCase& kept() const { return kept_; }
  /// Sets the labels that the first line names; a file of the case is not changed.
  void set_labels(std::filesystem::path labels) { kept_.labels = std::move(labels); }
  /// Before the case has a file.
  void set_record(std::string record) { kept_.record = std::move(record); }
  std::size_t history_bytes() const { return history_.bytes(); }

  // The file that keeps the case: every action is a line of it.

  bool unsynced() const { return journal() != nullptr && journal()->unsynced(); }
  Result<void> sync() { return unsynced() ? journal()->sync() : Result<void>{}; }
  /// If another program took the case's file away, the case goes on elsewhere [keep_case].
  void keep();
  /// A sentence on what keep() had to do; empty where it was nothing.
  const std::string& news() const { return news_; }
  void forget_news() { news_.clear(); }
  /// Whether apply() changed the case.
  bool edited() const { return edited_; }
  const CaseTemplates& templates() const { return templates_; }
  /// Before lines are read.
  void set_templates(CaseTemplates templates) { templates_ = std::move(templates); }

  const CaseLines& lines() const { return lines_; }
  Journal* journal() const { return lines_.journal(); }
  /// From now on every action is appended to `journal`, which holds this first line and all lines so far.
  Result<void> write_to(std::unique_ptr<Journal> journal, std::string first_line) {
    return lines_.write_to(std::move(journal), std::move(first_line));
  }
  void close_journal() { lines_.close_journal(); }

  // How a file is read: its lines one after the other, each played or (up to a checkpoint) only counted.

  /// The lines that follow are there already. `adjust` changes every action before it is played.
  void read_from(CaseLines lines, std::function<void(Action&)> adjust = {});
  /// As apply, of a line that is there.
  Result<EditReport> replay(EditStep step, const LinePlace& line);
  /// Counts a line without playing it; `lines_check` is that of the lines before it. False where the line cannot follow
  /// those before.
  bool count(const LineKind& kind, const LinePlace& line, std::uint32_t lines_check);
  /// The state that the lines counted so far lead to.
  void go_on_from(std::shared_ptr<const Document> document);

 private:
  Deformer& deformer_of(const Document& document, const std::string& of);
  void end_gestures();
  Result<void> follow(Document& document, const Compute& compute, const std::string& of);
  Result<EditReport> travel(const Action& action, const std::optional<LinePlace>& line);
  Result<EditReport> look(const SetFrame& action, const std::optional<LinePlace>& line);
  Result<EditReport> edit(EditStep step, const std::optional<LinePlace>& line);
  Result<EditReport> perform(EditStep step, const std::optional<LinePlace>& line);
  Result<void> begin_structures(const EditStep& step);
  Result<LinePlace> write(const std::string& line, bool is_note, bool sync);
  Result<EditStep> read_line(std::size_t step) const;
  Result<EditStep> read_step(std::size_t step);
  std::shared_ptr<const Document> nearest_state(std::size_t& state);
  Result<std::shared_ptr<const Document>> state(std::size_t state);
  EditName read_name(std::size_t step, const Document* before);
  std::string name(const std::optional<History::Way>& way);
  void add_steps(History::Step step);
  void keep(const Note& note);
  void tidy();
  void write_checkpoint();
  std::size_t steps_since_checkpoint() const;

  History history_;
  HistoryLimits limits_;
  std::shared_ptr<const Document> document_;  ///< the present state, at the frame that is looked at
  /// Looks at frames since the last step; they become part of the history with the next one.
  struct Look {
    std::string unwritten;  ///< its line, where it could not be written: the disk is full
    LinePlace line;
  };
  std::vector<Look> looks_;
  bool joinable_ = false;  ///< the last call of apply() that was no note made a step
  std::uint64_t steps_made_ = 0;
  KeptWithCase kept_;
  std::vector<LinePlace> kept_lines_;  ///< lines that were counted only, and say what is kept
  /// The structures that were moved last, by their ids, the latest first. Each has a factorisation of its own.
  std::list<std::pair<std::string, Deformer>> deformers_;
  CaseLines lines_;
  CaseTemplates templates_;
  std::size_t steps_to_checkpoint_ = 0;  ///< before which none is tried again
  std::function<void(Action&)> adjust_;
  int solves_ = 0;
  std::string news_;
  bool edited_ = false;
};

}  // namespace homolog
