#pragma once

#include <functional>

#include "core/adapt/fit.h"

namespace homolog {

/// The part that the template fits with least doubt, among a label's parts of about one size, mirrored fits last;
/// `largest` where there is one alone. `part`: the boundary of a part by its rank in size. The boundary says which was
/// taken.
Result<Boundary> likeliest_part(const Template& the_template, Boundary largest,
                                const std::function<Result<Boundary>(std::size_t rank)>& part,
                                const FitOptions& options);

}  // namespace homolog
