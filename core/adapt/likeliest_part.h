#pragma once

#include <functional>

#include "core/adapt/fit.h"

namespace homolog {

/// Of a label's parts of about one size the one that the template fits with least doubt, mirrored fits last; `largest`
/// where there is one alone. `part`: the boundary of a part by its rank in size. The boundary says which was taken.
Result<Boundary> likeliest_part(const Template& the_template, Boundary largest,
                                const std::function<Result<Boundary>(std::size_t rank)>& part,
                                const FitOptions& options);

}  // namespace homolog
