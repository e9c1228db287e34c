#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/statistics/design.h"
#include "core/statistics/permutations.h"

namespace homolog {

/// Which way a test looks. One-sided: only a change to more (greater) or to less of the response counts, from the first
/// group to the second or towards larger numbers.
enum class Sided { two, greater, less };

/// Whether a term of one response can be tested one-sidedly: it has two groups, or it is one column of numbers.
inline bool has_direction(const DesignTerm& term) {
  return term.levels.size() == 2 || term.numbers;
}

/// The test of one term.
struct TermTest {
  std::string name;
  Eigen::Index df = 0;
  double ss = 0;          ///< sum of squares of the second kind; of shapes mm², summed over all coordinates
  double r2 = 0;          ///< ss ÷ the total sum of squares
  double partial_r2 = 0;  ///< ss ÷ (ss + the residual sum of squares)
  double f = 0;
  double z = 0;  ///< how many deviations log F lies above the mean log F of the permutations; NaN without spread
  double p = 1;  ///< (b + 1) ÷ (m + 1), where b of m permutations gave an F as large, or a t as far to the side
  Sided sided = Sided::two;
  /// How much more of the response the second group has, or one standard deviation more of a number brings, the other
  /// terms held. NaN where there are several responses, or the term has no direction.
  double change = std::numeric_limits<double>::quiet_NaN();
};

/// Two groups of a term.
struct PairTest {
  std::string term, a, b;
  /// Between their means, the other terms held: root of the sum over all coordinates. With one response it is b less a.
  double distance = 0;
  double p = 1;  ///< p of the distance² ÷ the residual sum of squares: of two groups that of the term
  double q = 1;  ///< over the pairs of the term [Benjamini & Hochberg 1995]
};

/// The sum of a term that is taken out and not tested, as of subjects.
struct TermSum {
  std::string name;
  Eigen::Index df = 0;
  double ss = 0, r2 = 0;
};

/// The tests of all terms that are to be tested, and what they stand on.
struct LinearTest {
  std::vector<TermTest> terms;
  std::vector<TermSum> taken_out;
  std::vector<PairTest> pairs;
  Eigen::Index residual_df = 0;
  double residual_ss = 0, total_ss = 0;  ///< total: about the mean
};

/// Whether the F of a permutation counts as as large as the one found: what differs by rounding alone is equal.
inline bool is_as_large(double permuted, double found) {
  return permuted >= found - 1e-9 * (found > 1 ? found : 1);
}

/// Tests each term of a linear model of responses (a case a column) by permuting the residuals of the model without it
/// [Freedman & Lane 1983; Anderson & Legendre 1999; of shapes: Collyer, Sekora & Adams 2015]. F is the pseudo-F of
/// distances [Anderson 2001]; of one response it is the F of a linear model. Sums come from the inner products of the
/// cases alone, so that the number of coordinates hardly matters. `root_weights`: √w of each case, all 1 without
/// weights. A residual takes its weight along: so a test holds whether or not the weights are those of the errors, as
/// long as they do not go with the term. `sided`: of one response, for the terms that have a direction [has_direction]:
/// then the order is that of t, which is √F with the sign of the change. The same values for any number of threads.
LinearTest test_terms(const Design& design, const Eigen::MatrixXd& responses, const Eigen::VectorXd& root_weights,
                      const Permutations& permutations, Progress* progress = nullptr, Sided sided = Sided::two);

/// Responses less their mean, times √w: what the sums are taken of.
Eigen::MatrixXd weighted_responses(const Eigen::MatrixXd& responses, const Eigen::VectorXd& root_weights);

/// The smallest false discovery rate at which each of the tests counts [Benjamini & Hochberg 1995].
Eigen::VectorXd false_discovery_rates(const Eigen::VectorXd& p);

}  // namespace homolog
