#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/adapt/fit.h"
#include "core/adapt/judge_fit.h"
#include "core/template_making/mask_template.h"

namespace homolog {

/// A closing radius that was tried, and what came of the fit with it.
struct TriedClosing {
  double closing_mm = 0;
  double dice_raw = 0;  ///< the fitted mesh's Dice with the label as it is, not closed
  bool doubtful = false;
};

struct ClosingChoice {
  double closing_mm = 0;
  std::string why;  ///< half a sentence
  std::vector<TriedClosing> tried;
};

/// The radius where nothing else is known: ball_share of the label's size.
double usual_closing_mm(const Volume& mask, int label, int frame);
/// Radii that are tried beyond the usual one [ball_share]: the mean edge of a mesh of `vertices` vertices, and 1.25 of
/// it. Empty where the label does not occur.
std::vector<double> wider_closings_mm(const Volume& mask, int label, int frame, Eigen::Index vertices);

/// The closing radius for a template of a label, tried on the label itself: a template without its clefts, closed by
/// 1.5 edges, stands in for another subject's. If it cannot be fitted into the clefts that the usual radius leaves,
/// others' templates cannot either; then the widest radius is taken with which the fit is sound and its Dice to the raw
/// label next to the same. If it can, one edge is taken if that costs at most 0.001 of this Dice: others' clefts may
/// be deeper. Falls back to the usual radius, also where the closed label gets tunnels.
ClosingChoice choose_template_closing(const Volume& mask, const MaskTemplateOptions& options, Progress* progress);

/// The comment by which a template's file keeps a closing radius for its fits; and the radius that a template's source
/// keeps: none where it is no file or says none.
std::string closing_comment(double closing_mm);
std::optional<double> closing_kept_with(const std::string& source);

/// A fit with another closing radius than at first.
struct OtherClosing {
  double closing_mm = 0;
  Boundary boundary;
  FitResult fit;
  FitJudgement judgement;
};

struct MoreClosing {
  std::optional<OtherClosing> better;  ///< sound, with the best Dice to the raw label
  std::vector<TriedClosing> tried;     ///< the first fit, then the others; empty where nothing was tried
};

/// Tries wider radii where a fit to a label is doubtful and closing may help: not for mirrored organs, nor for partial
/// fits, labels that the scan cuts or templates of a part of the surface. One is better that gives a sound fit whose
/// raw Dice is next to the first's or higher. Nothing is tried where the first fit took all `parts`, or one of several
/// of about one size: a wider radius could join them.
MoreClosing try_more_closing(const Template& the_template, const Volume& mask, int label, int frame,
                             const LabelParts& parts, const FitOptions& options, const OtherClosing& first);

/// A closing radius in words, as "4.00 mm".
std::string mm_words(double mm);
/// The words of the warning: what was tried for a fit that stays doubtful.
std::string tried_in_vain(const std::vector<TriedClosing>& tried);

}  // namespace homolog
