#pragma once

#include <string>
#include <vector>

#include "app/verbs/verb.h"

namespace homolog {

/// The summary rows of `study schemes` as an SVG picture: a line a scheme, along it the error at landmarks that were
/// not shown, after placement (ring), after the features (small dot) and at the end (dot). Empty where no row has an
/// error.
std::string landmark_chart(const std::vector<Json>& rows);

}  // namespace homolog
