#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/adapt/fit.h"
#include "core/adapt/judge_fit.h"
#include "core/adapt/labels/choose_closing.h"

namespace homolog {

// The automatic fit to a label of a label map, as all that fit to label maps do it.

/// A label that a template is fitted to.
struct MapLabel {
  const Volume& map;
  int label = 1;
  int frame = 0;
  Segmentation known{};  ///< the map's description of its labels
};

struct LabelFitOptions {
  std::optional<double> closing_mm;       ///< as somebody asked for; without, wider ones are tried where that helps
  std::optional<double> kept_closing_mm;  ///< kept with the template [closing_kept_with]: tried first
  /// Whether every part of the label is the target, else one; without: as the template has pieces. Partial fits take
  /// all anyway.
  std::optional<bool> all_parts;
  bool largest_part = false;  ///< one part means the largest, not the likeliest
};

/// The closing radius that is tried first.
double first_closing_mm(const MapLabel& target, const LabelFitOptions& options);

/// The boundary of a label as a template is fitted to it: the part of its surface that the template is of, of all its
/// parts or of the likeliest [likeliest_part.h]. Errors: those of label_boundary and likeliest_part.
Result<Boundary> boundary_to_fit(const Template& the_template, const MapLabel& target, const LabelFitOptions& options,
                                 double closing_mm, const FitOptions& fitting);

/// A fit to a label.
struct LabelFit {
  Boundary boundary;
  FitResult fit;
  FitJudgement judgement;
  double closing_mm = 0;
  bool widened = false;             ///< a wider radius than the first was taken
  std::vector<TriedClosing> tried;  ///< radii; empty where no other one was
};

/// Fits a template to a boundary_to_fit and judges the fit. If nobody asked for a closing radius and the fit is
/// doubtful, wider ones are tried [try_more_closing], and one with which it is sound is taken. Errors: those of
/// check_frame_of, check_arguments, boundary_to_fit and fit_to_boundary.
Result<LabelFit> fit_to_label(const Template& the_template, const MapLabel& target, const LabelFitOptions& options,
                              const FitOptions& fitting);

/// Half a sentence: why this closing radius was taken.
std::string why_closing(const LabelFit& fitted, const LabelFitOptions& options);

}  // namespace homolog
