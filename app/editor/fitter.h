#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "app/editor/latest_wins.h"
#include "core/case/document.h"
#include "core/fit/mask_fit.h"
#include "core/measure/compare.h"

namespace homolog {

/// What the panel says about a fit.
struct FitSettings {
  int label = 0;           ///< 0: the label map's first
  double closing_mm = 1;   ///< radius: narrower clefts are filled
  bool as_placed = false;  ///< starts where the template is; else its place is found
};

/// A finished fit, with what it is judged by.
struct Fitted {
  FitResult fit;
  Agreement agreement;    ///< with the boundary that it was fitted to
  bool doubtful = false;  ///< see is_doubtful
  bool mirrored = false;  ///< the organ looks like the template's mirror image; see looks_mirrored
  std::vector<std::string> warnings;
};

/// Fits the shown frame's template to a label on a thread of its own. Called from the window's thread only.
class Fitter {
 public:
  /// `wake` is called from the thread after each step.
  explicit Fitter(std::function<void()> wake) : wake_(wake), work_(std::move(wake)) {}

  /// `labels` and the document must have the frame; the document must have a shape.
  void start(std::shared_ptr<const Document> document, std::shared_ptr<const Volume> labels,
             const FitSettings& settings);
  void cancel();
  bool busy() const { return work_.busy(); }
  double fraction() const { return work_.fraction(); }
  /// The document that is fitted, as it was when the fit began; null where nothing goes on.
  const std::shared_ptr<const Document>& document() const { return document_; }
  /// The shape so far, once a step.
  std::shared_ptr<const Points> take_step();
  /// The result, once.
  std::optional<Result<Fitted>> take();
  void finish() { work_.finish(); }

 private:
  struct Box {
    std::mutex mutex;
    std::shared_ptr<const Points> step;
  };
  std::function<void()> wake_;
  std::shared_ptr<Box> box_ = std::make_shared<Box>();
  std::shared_ptr<const Document> document_;
  LatestWins<Result<Fitted>> work_;
};

}  // namespace homolog
