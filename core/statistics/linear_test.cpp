#include "core/statistics/linear_test.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/processes/parallel.h"

namespace homolog {

namespace {

/// The rest of the inner products after the columns are fitted.
Eigen::MatrixXd residual_products(const Eigen::MatrixXd& products, const Eigen::MatrixXd& q) {
  const Eigen::MatrixXd left = products - q * (q.transpose() * products);
  return left - (left * q) * q.transpose();
}

/// Columns whose products with the residuals are those of `q` with the permuted residuals.
Eigen::MatrixXd unpermuted(const Eigen::MatrixXd& q, const Permutations& permutations, Eigen::Index row) {
  Eigen::MatrixXd moved(q.rows(), q.cols());
  for (Eigen::Index i = 0; i < q.rows(); ++i) moved.row(permutations(row, i)) = q.row(i);
  return moved;
}

/// The sum of squares of each column's product with the responses.
Eigen::VectorXd column_sums(const Eigen::MatrixXd& q, const Eigen::MatrixXd& products) {
  return (products * q).cwiseProduct(q).colwise().sum();
}

/// F, and the squared distance of every pair of groups, once as a share of what the whole model leaves: as with F,
/// that makes chance alike in every order.
struct Found {
  double f = 0, statistic = 0;  ///< the figures that p counts by: F, or t where one side counts
  Eigen::VectorXd pairs, pair_shares;
};

/// The difference of every two groups' means, as a column that is multiplied with the responses.
Eigen::MatrixXd pair_contrasts(const TermBasis& basis, const DesignTerm& term) {
  const auto groups = static_cast<Eigen::Index>(term.levels.size());
  Eigen::MatrixXd contrasts(basis.added.rows(), groups * (groups - 1) / 2);
  Eigen::Index pair = 0;
  for (Eigen::Index a = 0; a < groups; ++a)
    for (Eigen::Index b = a + 1; b < groups; ++b, ++pair) {
      contrasts.col(pair) = basis.contrasts.row(b - 1).transpose();
      if (a > 0) contrasts.col(pair) -= basis.contrasts.row(a - 1).transpose();
    }
  return contrasts;
}

/// What the residuals are multiplied with: the term's columns, those of the other terms, and the pairs of groups.
Eigen::MatrixXd columns_of(const TermBasis& basis, const DesignTerm& term) {
  const Eigen::MatrixXd pairs = pair_contrasts(basis, term);
  Eigen::MatrixXd columns(basis.added.rows(),
                          basis.added.cols() + basis.rest.cols() + basis.reduced.cols() + pairs.cols());
  columns << basis.added, basis.rest, basis.reduced, pairs;
  return columns;
}

/// One term's test, for the order as it is and for permutations.
class TermTester {
 public:
  /// `weighted`: the responses; `products`: their inner products.
  TermTester(const Design& design, std::size_t term, const Eigen::VectorXd& root_weights,
             const Eigen::MatrixXd& weighted, const Eigen::MatrixXd& products, Sided sided)
      : design_(design),
        number_(term),
        root_weights_(root_weights),
        weights_move_(!are_equal(root_weights)),
        term_(design.terms[term]),
        basis_(basis_of(design, term, root_weights)) {
    residual_ = residual_products(products, basis_.reduced);
    if (weighted.rows() == 1) {
      const Eigen::VectorXd y = weighted.transpose();
      left_of_one_ = y - basis_.reduced * (basis_.reduced.transpose() * y);
      if (has_direction(term_)) sided_ = sided;
    }
    total_ = residual_.trace();
    df_left_ = design.cases() - design.parameters();
    columns_ = columns_of(basis_, term_);
  }

  double ss() const { return column_sums(basis_.added, residual_).sum(); }
  double residual_ss() const {
    return total_ - column_sums(basis_.added, residual_).sum() - column_sums(basis_.rest, residual_).sum();
  }
  Sided sided() const { return sided_; }
  /// The change of one response [TermTest::change].
  double change() const {
    if (left_of_one_.size() == 0 || !has_direction(term_)) return std::numeric_limits<double>::quiet_NaN();
    return basis_.contrasts.row(0) * left_of_one_;
  }
  /// The sign of each pair of groups: −1 where of one response the second has less of it, else 1.
  Eigen::VectorXd pair_signs() const {
    const Eigen::MatrixXd contrasts = pair_contrasts(basis_, term_);
    Eigen::VectorXd signs = Eigen::VectorXd::Ones(contrasts.cols());
    if (left_of_one_.size() > 0) signs = ((contrasts.transpose() * left_of_one_).array() < 0).select(-signs, signs);
    return signs;
  }

  Found found() const { return found_with(columns_, basis_); }
  Found found(const Permutations& permutations, Eigen::Index row) const {
    if (!weights_move_) return found_with(unpermuted(columns_, permutations, row), basis_);
    const TermBasis basis = basis_of(design_, number_, taken_along(root_weights_, permutations, row));
    return found_with(unpermuted(columns_of(basis, term_), permutations, row), basis);
  }

 private:
  Found found_with(const Eigen::MatrixXd& columns, const TermBasis& basis) const {
    const Eigen::VectorXd sums = column_sums(columns, residual_);
    const Eigen::Index fitted = basis_.added.cols() + basis_.rest.cols() + basis_.reduced.cols();
    const double left = total_ - sums.head(fitted).sum();
    const double f =
        sums.head(term_.count).sum() / static_cast<double>(term_.count) / (left / static_cast<double>(df_left_));
    return {f, sided_ == Sided::two ? f : towards_side(columns.col(0).dot(left_of_one_), basis, f),
            sums.tail(sums.size() - fitted), sums.tail(sums.size() - fitted) / left};
  }

  /// t, above 0 on the side that counts. `along`: the product of what the term adds with the residuals, whose sign is
  /// that of the change but for that of the basis.
  double towards_side(double along, const TermBasis& basis, double f) const {
    const bool more = along * basis.contrasts.row(0).dot(basis.added.col(0)) > 0;
    return (more == (sided_ == Sided::greater) ? 1 : -1) * std::sqrt(std::max(f, 0.0));
  }

  const Design& design_;
  std::size_t number_;  ///< of the term
  Eigen::VectorXd root_weights_;
  bool weights_move_;  ///< with the residuals; equal ones need not
  const DesignTerm& term_;
  TermBasis basis_;
  Eigen::MatrixXd residual_;     ///< inner products of the reduced model's residuals
  Eigen::VectorXd left_of_one_;  ///< those residuals themselves of one response; else empty
  Sided sided_ = Sided::two;
  Eigen::MatrixXd columns_;
  double total_ = 0;
  Eigen::Index df_left_ = 0;
};

double p_of(Eigen::Index as_large, Eigen::Index permutations) {
  return static_cast<double>(as_large + 1) / static_cast<double>(permutations + 1);
}

double deviations_above(double f, const std::vector<Found>& permuted) {
  const auto log_of = [](double value) { return std::log(std::max(value, std::numeric_limits<double>::min())); };
  double sum = 0, squares = 0;
  for (const Found& one : permuted) sum += log_of(one.f);
  const double mean = sum / static_cast<double>(permuted.size());
  for (const Found& one : permuted) squares += (log_of(one.f) - mean) * (log_of(one.f) - mean);
  const double deviation = std::sqrt(squares / std::max(1.0, static_cast<double>(permuted.size()) - 1));
  return deviation > 0 ? (log_of(f) - mean) / deviation : std::numeric_limits<double>::quiet_NaN();
}

/// The pairs of the term that was tested last.
void add_pairs(const DesignTerm& term, const TermTester& tester, const Found& found, const std::vector<Found>& permuted,
               LinearTest& test) {
  Eigen::VectorXd p(found.pairs.size());
  for (Eigen::Index k = 0; k < p.size(); ++k)
    p[k] =
        p_of(std::count_if(permuted.begin(), permuted.end(),
                           [&](const Found& one) { return one.pair_shares[k] >= found.pair_shares[k] * (1 - 1e-9); }),
             static_cast<Eigen::Index>(permuted.size()));
  if (tester.sided() != Sided::two) p.setConstant(test.terms.back().p);  // a single pair
  const Eigen::VectorXd q = false_discovery_rates(p), signs = tester.pair_signs();
  Eigen::Index k = 0;
  for (std::size_t a = 0; a < term.levels.size(); ++a)
    for (std::size_t b = a + 1; b < term.levels.size(); ++b, ++k)
      test.pairs.push_back(
          {term.name, term.levels[a], term.levels[b], signs[k] * std::sqrt(found.pairs[k]), p[k], q[k]});
}

}  // namespace

Eigen::MatrixXd weighted_responses(const Eigen::MatrixXd& responses, const Eigen::VectorXd& root_weights) {
  const Eigen::VectorXd mean = responses.rowwise().mean();
  return (responses.colwise() - mean) * root_weights.asDiagonal();
}

Eigen::VectorXd false_discovery_rates(const Eigen::VectorXd& p) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(p.size()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) { return p[a] < p[b]; });
  Eigen::VectorXd q(p.size());
  double least = 1;
  for (std::size_t rank = order.size(); rank-- > 0;) {
    least = std::min(least, p[order[rank]] * static_cast<double>(p.size()) / static_cast<double>(rank + 1));
    q[order[rank]] = least;
  }
  return q;
}

LinearTest test_terms(const Design& design, const Eigen::MatrixXd& responses, const Eigen::VectorXd& root_weights,
                      const Permutations& permutations, Progress* progress, Sided sided) {
  const Eigen::MatrixXd weighted = weighted_responses(responses, root_weights);
  const Eigen::MatrixXd products = weighted.transpose() * weighted;
  LinearTest test;
  test.residual_df = design.cases() - design.parameters();
  test.total_ss = residual_products(products, root_weights.normalized()).trace();
  std::size_t done = 0;
  for (std::size_t t = 0; t < design.terms.size(); ++t) {
    const DesignTerm& term = design.terms[t];
    const TermTester tester(design, t, root_weights, weighted, products, sided);
    if (!term.tested) {
      test.taken_out.push_back({term.name, term.count, tester.ss(), tester.ss() / test.total_ss});
      continue;
    }
    test.residual_ss = tester.residual_ss();
    const Found found = tester.found();
    std::vector<Found> permuted(static_cast<std::size_t>(permutations.rows()));
    in_parallel(permutations.rows(), [&](Eigen::Index first, Eigen::Index last) {
      for (Eigen::Index row = first; row < last; ++row) {
        if (progress != nullptr && progress->cancelled()) return;
        permuted[row] = tester.found(permutations, row);
      }
    });
    if (progress != nullptr) {
      if (progress->cancelled()) return test;
      progress->report(static_cast<double>(++done) / static_cast<double>(design.terms.size()));
    }
    const auto as_large = std::count_if(permuted.begin(), permuted.end(),
                                        [&](const Found& one) { return is_as_large(one.statistic, found.statistic); });
    const double ss = tester.ss();
    test.terms.push_back({.name = term.name,
                          .df = term.count,
                          .ss = ss,
                          .r2 = ss / test.total_ss,
                          .partial_r2 = ss / (ss + test.residual_ss),
                          .f = found.f,
                          .z = deviations_above(found.f, permuted),
                          .p = p_of(as_large, permutations.rows()),
                          .sided = tester.sided(),
                          .change = tester.change()});
    add_pairs(term, tester, found, permuted, test);
  }
  return test;
}

}  // namespace homolog
