#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/editor/state/models/study_model.h"
#include "app/editor/state/outcomes.h"
#include "app/editor/work/mailbox.h"
#include "app/editor/work/worker.h"
#include "core/adapt/fit.h"
#include "core/case/action.h"
#include "core/measure/compare.h"
#include "core/volume/labels/segmentation.h"

namespace homolog {

/// A label map with its name, for sentences.
struct NamedLabels {
  std::shared_ptr<const Volume> volume;
  std::string name;
  Segmentation known{};  ///< its description of its labels
};

/// The label that most of a mesh's inside lies in (half way from each vertex to the middle); 0 where that is none.
int label_at_mesh(const Volume& labels, int frame, const Points& points);

/// The shape model that a fit keeps to at first; none where both are null.
struct ModelOfFit {
  std::shared_ptr<const StudyModel> study;  ///< its shapes without the one of the case that is fitted
  std::string left_out;                     ///< the case's name; empty where it is none of the study's
  bool flipped = false;                     ///< the case has the other side, and the study holds it flipped
  std::shared_ptr<const ShapeModel> model;  ///< one that was read from a file, which goes before
};

/// Fits the template of a case to a label, and judges what came of it. Errors: those of the label map, of the model and
/// of the fit.
Result<Fitted> fit_to_labels(const ShapeView& shown, const NamedLabels& labels, const FitSettings& settings,
                             const ModelOfFit& model, FitOptions options);

/// Fits the shown frame's template to a label, or to the surface that the mesh has already (see refine), on a thread of
/// its own. Called from the window's thread only.
class Fitter {
 public:
  /// `wake` is called from the thread after each step.
  explicit Fitter(std::function<void()> wake) : wake_(wake), work_(std::move(wake)) {}

  /// `labels` and the document must have the frame; the document must have a shape.
  /// `of`: the structure; empty: the first.
  void start_fit(std::shared_ptr<const Document> document, NamedLabels labels, const FitSettings& settings,
                 const ModelOfFit& model = {}, std::string of = {});
  void start_refinement(std::shared_ptr<const Document> document, std::string of = {});
  void cancel();
  bool busy() const { return work_.busy(); }
  bool refining() const { return refining_ && busy(); }
  double fraction() const { return work_.fraction(); }
  /// The document that is fitted, as it was when the fit began; null where nothing goes on.
  const std::shared_ptr<const Document>& document() const { return document_; }
  const std::string& of() const { return of_; }
  /// The shape so far, once a step; a refinement shows none.
  std::shared_ptr<const Points> take_step();
  /// The result, once.
  std::optional<Result<Fitted>> take();
  void finish() { work_.finish(); }

 private:
  std::function<void()> wake_;
  using Steps = Mailbox<std::shared_ptr<const Points>>;
  std::shared_ptr<Steps> steps_ = std::make_shared<Steps>();
  std::shared_ptr<const Document> document_;
  std::string of_;
  bool refining_ = false;
  Worker<Fitted> work_;
};

}  // namespace homolog
