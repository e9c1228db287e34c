#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "core/base/processes/progress.h"

namespace homolog {

/// How many modes hold more than chance, by parallel analysis [Horn 1965]: those whose variance is above the 95th
/// percentile of what the same mode has where every coordinate is shuffled over the cases by itself, the first ones up
/// to where that ends. `responses`: a case a column. The seed alone decides the 99 shuffles.
Eigen::Index modes_above_chance(const Eigen::MatrixXd& responses, std::uint64_t seed, Progress* progress = nullptr);

}  // namespace homolog
