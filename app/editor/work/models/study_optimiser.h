#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "app/editor/state/models/study_optimisation.h"
#include "app/editor/work/mailbox.h"
#include "app/editor/work/worker.h"

namespace homolog {

/// Optimises the shapes of a study on a thread of its own: as `model --optimise` does it, with the same bits. Called
/// from the window's thread only.
class StudyOptimiser {
 public:
  /// `wake` is called from the thread after each round.
  explicit StudyOptimiser(std::function<void()> wake) : wake_(wake), work_(std::move(wake)) {}

  /// The study's model must have faces. A run before it is given up.
  void start(std::shared_ptr<const StudyToOptimise> study);
  void cancel() { work_.cancel(); }
  bool busy() const { return work_.busy(); }
  double fraction() const { return work_.fraction(); }
  /// The rounds so far, once a round.
  std::optional<std::vector<GroupwiseRound>> take_rounds() { return rounds_->take(); }
  /// The result, once. Its last round comes before it.
  std::optional<Result<OptimisedStudy>> take() { return work_.take(); }

 private:
  using Rounds = Mailbox<std::vector<GroupwiseRound>>;
  std::function<void()> wake_;
  std::shared_ptr<Rounds> rounds_ = std::make_shared<Rounds>();  ///< the latest job's; those before have their own
  Worker<OptimisedStudy> work_;
};

}  // namespace homolog
