#pragma once

#include <memory>
#include <optional>
#include <string>

#include "app/editor/latest_wins.h"
#include "app/editor/study_model.h"
#include "core/case/document.h"

namespace homolog {

/// What the shape model of a study makes of the case: computed once on a thread of its own, then blended in at any
/// strength. Called from the window's thread only.
class ModelHelp {
 public:
  /// `wake` is called from the thread when it is computed.
  explicit ModelHelp(std::function<void()> wake) : work_(std::move(wake)) {}

  /// Asks for the shown frame's shape completed by the model of all other cases, from what is confirmed; `name` is the
  /// case's in the study, empty where it is none of its. Does nothing where that is known already.
  void ask(std::shared_ptr<const Document> document, std::shared_ptr<const StudyModel> model, const std::string& name);
  /// The shape at a strength 0…1; null while it is computed, and where it cannot be.
  std::shared_ptr<const Points> at(double strength) const;
  /// Takes in what the thread did; gives the sentence where it failed.
  std::optional<std::string> update();
  bool busy() const { return work_.busy(); }

 private:
  std::shared_ptr<const Document> document_;
  std::shared_ptr<const StudyModel> model_;
  std::shared_ptr<const Points> completed_;  ///< at strength 1
  LatestWins<Result<Points>> work_;
};

}  // namespace homolog
