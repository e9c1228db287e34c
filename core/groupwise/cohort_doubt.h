#pragma once

#include <vector>

#include "core/adapt/fit.h"

namespace homolog {

/// Which of several fits to go by as third subjects: up to `count`, those in least doubt first (as a share of their
/// size), of equal ones the first. Mirrored ones are not among them. Null: a case that was not fitted.
std::vector<std::size_t> third_subjects(const std::vector<const FitResult*>& fits, std::size_t count);

/// How far each vertex of a fit lies from where it comes out by way of third subjects: the template was fitted to these
/// (`others`, n×3 each, in the template's numbering), and each of these shapes is now the template of this subject.
/// Squared, mm²; of the ways' distances the upper third does not count, since a way may go wrong as a whole. Ways that
/// fail are left out. Empty where fewer than two are left. Errors: cancelled.
Result<VertexScalars> spread_by_others_mm2(const Template& the_template, const std::vector<const Points*>& others,
                                           const Boundary& boundary, const FitOptions& options, const FitResult& fit);

/// The doubt of a fit once that is known: its own counts less.
/// `spread_mm2`: see spread_by_others_mm2. The scale was set on vertebrae and femora with experts' landmarks
/// (docs/correspondence.md).
VertexScalars doubt_among_others_mm(const VertexScalars& doubt_mm, const VertexScalars& spread_mm2);

}  // namespace homolog
