#include "core/statistics/landmark_test.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/processes/parallel.h"
#include "core/statistics/linear_test.h"

namespace homolog {

namespace {

constexpr Eigen::Index vertices_at_once = 64;  ///< as many as a processor's cache holds with all cases
constexpr Eigen::Index orders_at_once = 256;

/// The sum over x, y and z of each vertex.
Eigen::ArrayXd over_vertices(const Eigen::VectorXd& coordinates) {
  const Eigen::Index vertices = coordinates.size() / 3;
  Eigen::ArrayXd sums(vertices);
  for (Eigen::Index v = 0; v < vertices; ++v)
    sums[v] = coordinates[3 * v] + coordinates[3 * v + 1] + coordinates[3 * v + 2];
  return sums;
}

/// Vertices tested in several orders of the residuals, whose model columns stand side by side, the term's first.
class VertexBlock {
 public:
  VertexBlock(const Eigen::MatrixXd& residuals, Eigen::Index first, Eigen::Index count, Eigen::Index df,
              Eigen::Index model_columns, double degrees)
      : residuals_(residuals.middleRows(3 * first, 3 * count)), df_(df), columns_(model_columns), degrees_(degrees) {
    total_ = over_vertices(residuals_.rowwise().squaredNorm());
  }

  /// Calls `use(F of each vertex)` for each order.
  template <class Use>
  void for_each(const Eigen::MatrixXd& orders, const Use& use) const {
    const Eigen::MatrixXd squares = (residuals_ * orders).array().square();
    for (Eigen::Index at = 0; at < squares.cols(); at += columns_) {
      const Eigen::ArrayXd term = over_vertices(squares.middleCols(at, df_).rowwise().sum());
      const Eigen::ArrayXd fitted = over_vertices(squares.middleCols(at, columns_).rowwise().sum());
      const Eigen::ArrayXd f = degrees_ * term / (total_ - fitted);
      use(f);
    }
  }

 private:
  Eigen::MatrixXd residuals_;
  Eigen::ArrayXd total_;
  Eigen::Index df_, columns_;
  double degrees_;  ///< degrees of freedom, those left ÷ those of the term
};

/// The model's columns, the term's first; without the first `constant` of the reduced model.
Eigen::MatrixXd model_columns(const TermBasis& basis, Eigen::Index constant) {
  const Eigen::Index reduced = basis.reduced.cols() - constant;
  Eigen::MatrixXd model(basis.added.rows(), basis.added.cols() + basis.rest.cols() + reduced);
  model << basis.added, basis.rest, basis.reduced.rightCols(reduced);
  return model;
}

/// The model's columns for the permutations from `first` on, side by side. `model_of(row)` gives them for one.
Eigen::MatrixXd ordered(const auto& model_of, const Permutations& permutations, Eigen::Index first,
                        Eigen::Index count) {
  Eigen::MatrixXd all;
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::MatrixXd& model = model_of(first + k);
    if (k == 0) all.resize(model.rows(), model.cols() * count);
    for (Eigen::Index i = 0; i < model.rows(); ++i)
      all.row(permutations(first + k, i)).segment(k * model.cols(), model.cols()) = model.row(i);
  }
  return all;
}

void effects(const DesignTerm& term, const TermBasis& basis, const Eigen::MatrixXd& weighted, LandmarkTest& test) {
  const Eigen::Index vertices = weighted.rows() / 3;
  const auto lengths = [](const Eigen::VectorXd& offset) -> Eigen::VectorXd {
    return over_vertices(offset.cwiseAbs2()).sqrt();
  };
  if (term.levels.empty() && !term.numbers) {
    const Eigen::MatrixXd added = weighted * basis.added;
    test.effect = (over_vertices(added.rowwise().squaredNorm()) / static_cast<double>(weighted.cols())).sqrt().matrix();
    return;
  }
  const Eigen::MatrixXd offsets = weighted * basis.contrasts.transpose();
  test.effect.setZero(vertices);
  for (Eigen::Index a = -1; a < offsets.cols(); ++a)
    for (Eigen::Index b = a + 1; b < offsets.cols(); ++b) {
      Eigen::VectorXd between = offsets.col(b);
      if (a >= 0) between -= offsets.col(a);
      test.effect = test.effect.cwiseMax(lengths(between));
    }
  if (offsets.cols() == 1) test.offset = offsets.col(0).reshaped(3, vertices).transpose();
}

}  // namespace

LandmarkTest test_landmarks(const Design& design, std::size_t term, const Eigen::MatrixXd& responses,
                            const Eigen::VectorXd& root_weights, const Permutations& permutations, Progress* progress) {
  const TermBasis basis = basis_of(design, term, root_weights);
  const Eigen::MatrixXd weighted = weighted_responses(responses, root_weights);
  const Eigen::MatrixXd residuals = weighted - (weighted * basis.reduced) * basis.reduced.transpose();
  // Residuals sum to 0 in any order, unless they have weights: the constant fits nothing of them.
  const bool equal = are_equal(root_weights);
  const Eigen::Index constant = equal ? 1 : 0;
  Eigen::MatrixXd model = model_columns(basis, constant);
  const Eigen::Index vertices = responses.rows() / 3, df = basis.added.cols();
  const double degrees = static_cast<double>(design.cases() - design.parameters()) / static_cast<double>(df);

  Eigen::ArrayXd found(vertices);
  Eigen::ArrayXi as_large = Eigen::ArrayXi::Zero(vertices);
  const auto in_blocks = [&](const Eigen::MatrixXd& orders, const auto& use) {
    in_parallel((vertices + vertices_at_once - 1) / vertices_at_once, [&](Eigen::Index first, Eigen::Index last) {
      for (Eigen::Index block = first; block < last; ++block) {
        const Eigen::Index at = block * vertices_at_once, count = std::min(vertices_at_once, vertices - at);
        const VertexBlock there(residuals, at, count, df, model.cols(), degrees);
        there.for_each(orders, [&](const Eigen::ArrayXd& f) { use(at, count, f); });
      }
    });
  };
  in_blocks(model, [&](Eigen::Index at, Eigen::Index count, const Eigen::ArrayXd& f) { found.segment(at, count) = f; });
  // What is left of a vertex that no case moves is rounding, which all such vertices share.
  constexpr double rounding = 1e-24;
  const Eigen::ArrayXd left = over_vertices(residuals.rowwise().squaredNorm()),
                       all = over_vertices(weighted.rowwise().squaredNorm());
  found = (left > rounding * all).select(found, std::numeric_limits<double>::quiet_NaN());
  // A residual takes its weight along.
  const auto model_of = [&](Eigen::Index row) -> const Eigen::MatrixXd& {
    if (!equal) model = model_columns(basis_of(design, term, taken_along(root_weights, permutations, row)), constant);
    return model;
  };
  for (Eigen::Index done = 0; done < permutations.rows(); done += orders_at_once) {
    if (progress != nullptr && progress->cancelled()) break;
    const Eigen::Index now = std::min(orders_at_once, permutations.rows() - done);
    in_blocks(ordered(model_of, permutations, done, now),
              [&](Eigen::Index at, Eigen::Index count, const Eigen::ArrayXd& f) {
                // As large, or nothing varies there (not a number).
                for (Eigen::Index v = 0; v < count; ++v)
                  as_large[at + v] += f[v] < found[at + v] && !is_as_large(f[v], found[at + v]) ? 0 : 1;
              });
    if (progress != nullptr)
      progress->report(static_cast<double>(done + now) / static_cast<double>(permutations.rows()));
  }
  LandmarkTest test;
  test.p = ((as_large.cast<double>() + 1) / static_cast<double>(permutations.rows() + 1)).matrix();
  test.q = false_discovery_rates(test.p);
  effects(design.terms[term], basis, weighted, test);
  return test;
}

}  // namespace homolog
