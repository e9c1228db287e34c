#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/case/action.h"
#include "core/case/journal.h"

namespace homolog {

/// An action as the journal holds it.
struct EditStep {
  Action action;
  /// Undone and redone together with the one before it: the further touches of a brush stroke, the points of a list.
  bool joined = false;
};

/// What is made of a document by something that is no action itself: an action that does the same, or none.
using Compute = std::function<Result<std::optional<Action>>(const Document&)>;

/// A case being edited: the document, its history and its journal. Belongs to one thread.
/// An action is computed, then written and synced to the journal, then shown as done.
class EditSession {
 public:
  explicit EditSession(Document document);

  const Document& document() const { return *history_[current_]; }
  std::shared_ptr<const Document> shared_document() const { return history_[current_]; }
  /// Moves the placement that a case starts from; nothing has been done yet.
  Result<void> start_at(const Similarity& placement);
  /// Applies an action (Undo and Redo too). `joined`: see EditStep; an action begins a step of its own all the same
  /// where the one before it was refused or taken back. On error nothing has changed, in memory or on disk.
  Result<EditReport> apply(Action action, bool joined = false);
  /// What the action would give, without doing it. Cheap while a drag goes on: the gesture is cached. Without an action
  /// it starts from the document; `then` carry on from there one after the other, and what one refuses is a message.
  Result<Updated> preview(const std::optional<Action>& action, const std::vector<Compute>& then = {});

  bool can_undo() const { return current_ > 0; }
  bool can_redo() const { return current_ + 1 < history_.size(); }
  /// Name of what undo (redo) would take back (do again); empty where there is nothing.
  std::string undo_name() const;
  std::string redo_name() const;

  /// From now on every action is appended to `journal`, which holds the actions so far already.
  void write_to(std::unique_ptr<Journal> journal) { journal_ = std::move(journal); }
  Journal* journal() { return journal_.get(); }
  const Document& initial_document() const { return *history_.front(); }
  /// What led from the initial document to the present one.
  std::span<const EditStep> steps_done() const { return {steps_.data(), current_}; }
  int strokes() const;  ///< those left after undo
  int solves() const { return solves_; }

 private:
  Result<void> follow(Document& document, const Compute& compute);
  Result<EditReport> travel(const Action& action);
  Result<EditReport> edit(Action action, bool joined);
  Result<void> write(const Action& action, bool joined = false);

  std::vector<std::shared_ptr<const Document>> history_;
  std::vector<EditStep> steps_;  ///< steps_[k] led from history_[k] to history_[k + 1]
  std::size_t current_ = 0;
  bool joinable_ = false;  ///< the last call of apply() made a step
  Deformer deformer_;
  std::unique_ptr<Journal> journal_;
  int solves_ = 0;
};

}  // namespace homolog
