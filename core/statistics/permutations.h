#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/base/result.h"

namespace homolog {

/// A permutation a row: case i gets the residual of case row[i], counted from 0.
using Permutations = Eigen::Matrix<int, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The values (one a case) that cases have together with the residuals that they get in permutation `row`.
Eigen::VectorXd taken_along(const Eigen::VectorXd& values, const Permutations& permutations, Eigen::Index row);

/// `count` random permutations of `blocks.size()` cases, which the seed alone decides. Cases change places only with
/// cases of the same block. The order as it is may be among them by chance; it is not put there.
Permutations random_permutations(const std::vector<int>& blocks, Eigen::Index count, std::uint64_t seed);

/// The number of ways in which the cases can change places so that a test comes out differently: within their blocks,
/// and cases of equal rows in `design` are alike. If all blocks hold two kinds of equal number, to exchange the kinds
/// changes no F, so that half of the ways count. Infinite where there are very many.
double different_orders(const std::vector<int>& blocks, const Eigen::MatrixXd& design);

/// Reads permutations of `cases` cases from a text file: one a line, numbers from 0 with blanks or commas between them.
/// Errors: unreadable, a line that is no permutation of 0 … cases − 1.
Result<Permutations> read_permutations(const std::filesystem::path& path, Eigen::Index cases);

}  // namespace homolog
