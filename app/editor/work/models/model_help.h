#pragma once

#include <memory>
#include <optional>
#include <string>

#include "app/editor/state/models/study_model.h"
#include "app/editor/work/worker.h"
#include "core/session/session.h"

namespace homolog {

/// The model of all shapes of a study but one; of all where `left_out` is −1. Errors: too few are left.
Result<ShapeModel> model_without(const StudyModel& study, std::ptrdiff_t left_out);
/// The same as the study's own model is made and written: its modes hold 95 % of the variance, and it knows how far
/// each of its shapes lies from the model of the others.
Result<ShapeModel> model_of_others(const StudyModel& study, std::ptrdiff_t left_out);

/// Completes the case's shape by the shape model of its study. The model is computed on a thread of its own; shapes are
/// completed on the session's thread. Called from the window's thread only.
class ModelHelp {
 public:
  /// `wake` is called from the thread when it is computed.
  explicit ModelHelp(std::function<void()> wake) : work_(std::move(wake)) {}

  /// Asks for the model of all cases but the one called `name` (empty where the open case is none of the study's). Does
  /// nothing where that is known already. `flipped`: that case has the other side, and the study holds it flipped.
  void ask(std::shared_ptr<const StudyModel> study, const std::string& name, bool flipped);
  /// Moves the shown frame's mesh towards what the model expects, given the known vertices. It starts from the shape as
  /// the edits alone made it; `strength` 0…1 says how far it goes. Empty at 0, while the model is computed, and where
  /// it cannot be.
  Compute completion(double strength) const;
  /// Takes in what the thread did; gives the sentence where it failed.
  std::optional<std::string> update();
  bool busy() const { return work_.busy(); }
  void finish() { work_.finish(); }

 private:
  struct Completer;
  std::shared_ptr<const StudyModel> study_;
  std::string name_;
  bool flipped_ = false;
  std::shared_ptr<Completer> completer_;
  Worker<ShapeModel> work_;  ///< with_pose
};

}  // namespace homolog
