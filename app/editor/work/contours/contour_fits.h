#pragma once

#include <memory>
#include <optional>
#include <string>

#include "app/editor/state/outcomes.h"
#include "core/assist/assist.h"
#include "core/base/processes/progress.h"
#include "core/session/session_thread.h"
#include "core/volume/labels/segmentation.h"

namespace homolog {

/// How the window fits to contours.
struct ContourFitJob {
  BetweenCurves between = BetweenCurves::shape;
  std::shared_ptr<const Volume> labels;  ///< for BetweenCurves::label
  Segmentation known;                    ///< the map's description of its labels
  FitSettings fit;                       ///< the label, and how far clefts are closed
  SnapSettings snap;                     ///< for BetweenCurves::image
  bool goes_on = false;                  ///< see fit_shape_to_contours
};

/// The mesh to the contours alone, for a preview. If that fails, the mesh stays as it is and there is no error.
Compute contour_compute();

/// Fits the case's mesh to its contours on the session's thread, each fit one edit. The latest wins: one that still
/// runs is given up.
class ContourFits {
 public:
  /// `joined`: undone together with the edit before it. `of`: the structure; empty: the first.
  void start(SessionThread& session, const ContourFitJob& job, bool joined, const std::string& of);
  void cancel();
  bool busy() const;
  double fraction() const;
  /// The outcome of the latest fit, once.
  std::optional<ContoursFitted> take();

 private:
  struct Box;
  std::shared_ptr<Box> box_;
};

}  // namespace homolog
