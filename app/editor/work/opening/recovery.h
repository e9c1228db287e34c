#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "app/editor/state/dialogs.h"
#include "app/editor/work/worker.h"

namespace homolog {

/// Looks for cases that were never saved, on a thread of its own: first what they are called, so that a thousand of
/// them are offered at once, then, where that is asked for, how much was done in each. Those that a killed program left
/// as they were opened are removed.
class Recovery {
 public:
  /// `wake` is called from the thread when there is something to take.
  explicit Recovery(std::function<void()> wake) : work_(std::move(wake)) {}

  void look();
  bool busy() const { return work_.busy(); }
  struct Found {
    std::vector<RecoverDialog::Found> cases;  ///< newest first
    bool counted = false;                     ///< their details say how many edits they hold
  };
  /// Counts the edits of what was found: reads the files whole, so only where somebody looks at the figures.
  void count(Found found);
  /// The unsaved cases found, or their edits counted; once. Errors: the folder cannot be read.
  std::optional<Result<Found>> take() { return work_.take(); }
  void finish() { work_.finish(); }

 private:
  Worker<Found> work_;
};

/// Removes the journal of an unsaved case, whatever it holds. Gives false where another program has it open: it stays.
bool discard_journal(const std::filesystem::path& journal);

/// Removes a journal of an unsaved case that holds no edit: it was left as it was opened. Any other file stays.
void remove_without_edits(const std::filesystem::path& journal);

}  // namespace homolog
