#include "core/statistics/linear_test.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

#include "core/base/numbers/random.h"
#include "core/base/processes/parallel.h"
#include "core/statistics/landmark_test.h"
#include "core/statistics/parallel_analysis.h"
#include "tests/must.h"
#include "tests/thread_limit.h"

// Tests by permutation. tests/scripts/statistics_test.py compares them with numpy and R.

namespace homolog {

namespace {

const std::vector<std::string> groups{"a", "b", "c", "a", "b", "c", "a", "b", "c", "a"};
const std::vector<int> together(10, 0);

Design design_of(const char* formula) {
  const auto code = [](const Variable& variable) -> Result<CodedVariable> {
    if (variable.name == "g") return coded_groups("g", groups);
    Eigen::VectorXd values(10);
    values << 1, 4, 2, 8, 5, 7, 3, 9, 6, 2;
    return coded_numbers("x", values);
  };
  return test::must(make_design(test::must(read_formula(formula)).terms, 0, code));
}

Eigen::MatrixXd response() {
  Eigen::MatrixXd y(1, 10);
  y << 2.5, 3.5, 9, 7, 5, 12.5, 3, 8.5, 11, 4;
  return y;
}

Eigen::MatrixXd noise_shapes(std::uint64_t seed, Eigen::Index vertices) {
  Random random(seed);
  return Eigen::MatrixXd::NullaryExpr(3 * vertices, 10, [&] { return random.normal(); });
}

bool near(double value, double expected) {
  return std::abs(value - expected) <= 1e-9 * std::max(1.0, std::abs(expected));
}

const Eigen::VectorXd even = Eigen::VectorXd::Ones(10);

}  // namespace

TEST_CASE("sums of the second kind and F are those of R") {
  // drop1(lm(y ~ g + x), test = "F") and anova(lm(y ~ g * x)) of R 4.2.2.
  const Permutations orders = random_permutations(together, 99, 1);
  const LinearTest sums = test_terms(design_of("y ~ g + x"), response(), even, orders);
  CHECK(near(sums.total_ss, 112.4));
  CHECK(near(sums.residual_ss, 3.0986842105263164));
  CHECK(sums.residual_df == 6);
  CHECK(near(sums.terms[0].ss, 69.135530180075762));
  CHECK(near(sums.terms[1].ss, 28.422149122807021));
  CHECK(near(sums.terms[0].f, 66.933761703003270));
  CHECK(near(sums.terms[1].f, 55.033970276008482));
  const LinearTest crossed = test_terms(design_of("y ~ g * x"), response(), even, orders);
  CHECK(near(crossed.terms[0].ss, 69.135530180075762));
  CHECK(near(crossed.terms[2].ss, 1.2456464436954455));
  CHECK(near(crossed.terms[2].f, 1.3444371895622971));
  CHECK(near(crossed.residual_ss, 1.8530377668308708));
}

TEST_CASE("weighted sums are those of R") {
  // drop1(lm(y ~ g + x, weights = w), test = "F") of R 4.2.2.
  Eigen::VectorXd weights(10);
  weights << 1, .5, 1, .25, 1, 1, .5, 1, 1, 1;
  const LinearTest sums =
      test_terms(design_of("y ~ g + x"), response(), weights.cwiseSqrt(), random_permutations(together, 9, 1));
  CHECK(near(sums.terms[0].ss, 58.530287675466255));
  CHECK(near(sums.terms[1].ss, 18.705247334705490));
  CHECK(near(sums.terms[0].f, 78.275644887271412));
  CHECK(near(sums.terms[1].f, 50.031030293866515));
}

TEST_CASE("one-sided p counts the orders whose t lies as far to the side, and both sides share them") {
  const Permutations orders = random_permutations(together, 999, 5);
  const Design design = design_of("y ~ g + x");
  const LinearTest two = test_terms(design, response(), even, orders);
  const LinearTest greater = test_terms(design, response(), even, orders, nullptr, Sided::greater);
  const LinearTest less = test_terms(design, response(), even, orders, nullptr, Sided::less);
  CHECK(two.terms[1].sided == Sided::two);
  CHECK(greater.terms[1].sided == Sided::greater);
  CHECK(two.terms[1].change > 0);
  CHECK(greater.terms[1].change == two.terms[1].change);
  CHECK(greater.terms[1].p < 0.01);
  CHECK(less.terms[1].p > 0.99);
  CHECK(greater.terms[1].f == two.terms[1].f);
  // Three groups have no side.
  CHECK(greater.terms[0].sided == Sided::two);
  CHECK(greater.terms[0].p == two.terms[0].p);
  CHECK(std::isnan(two.terms[0].change));
  // The other way round it is the other side's.
  const LinearTest turned = test_terms(design, -response(), even, orders, nullptr, Sided::less);
  CHECK(turned.terms[1].p == greater.terms[1].p);
  CHECK(near(turned.terms[1].change, -two.terms[1].change));
  // Pairs of one response have a sign: the second less the first.
  CHECK(near(two.pairs[0].distance, -test_terms(design, -response(), even, orders).pairs[0].distance));
  CHECK(near(two.pairs[1].distance - two.pairs[0].distance, two.pairs[2].distance));
}

TEST_CASE("p is 1 where every order is the one found and never 0") {
  Permutations same(9, 10);
  for (Eigen::Index row = 0; row < 9; ++row) std::iota(same.row(row).begin(), same.row(row).end(), 0);
  const Design design = design_of("y ~ g + x");
  for (const TermTest& one : test_terms(design, response(), even, same).terms) CHECK(one.p == 1);
  CHECK(test_landmarks(design, 0, noise_shapes(3, 5), even, same).p == Eigen::VectorXd::Ones(5));
  for (const TermTest& one : test_terms(design, 1e6 * response(), even, random_permutations(together, 9, 1)).terms)
    CHECK(one.p >= 0.1);
}

TEST_CASE("p is 1 at vertices that no case moves, whatever rounding leaves of them") {
  constexpr Eigen::Index fixed = 60, moved = 20;
  Eigen::MatrixXd shapes = noise_shapes(7, fixed + moved);
  shapes.topRows(3 * fixed).colwise() = Eigen::VectorXd(17.3 * shapes.topRows(3 * fixed).col(0));
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const LandmarkTest test =
        test_landmarks(design_of("shape ~ g + x"), 0, shapes, even, random_permutations(together, 199, seed));
    CHECK(test.p.head(fixed) == Eigen::VectorXd::Ones(fixed));
    CHECK(test.p.tail(moved).maxCoeff() < 1);
  }
}

TEST_CASE("chance alone is found as often by weights that are not those of the errors") {
  // Two of the cases weigh much, whichever. Residuals times √w that change places would find something in a third.
  Eigen::VectorXd weights = Eigen::VectorXd::Constant(10, 0.02);
  weights[2] = weights[7] = 1;
  const Design design = design_of("shape ~ x");
  constexpr int sets = 400;
  int found = 0;
  for (int k = 0; k < sets; ++k) {
    const auto seed = static_cast<std::uint64_t>(k + 1);
    const Eigen::VectorXd any = taken_along(weights, random_permutations(together, 1, seed + 2000), 0);
    const LinearTest test =
        test_terms(design, noise_shapes(seed, 4), any.cwiseSqrt(), random_permutations(together, 99, seed + 1000));
    found += test.terms.front().p <= 0.05 ? 1 : 0;
  }
  CHECK(found < 0.09 * sets);
  CHECK(found > 0.015 * sets);
}

TEST_CASE("one vertex alone is tested as the whole shape is") {
  const Eigen::MatrixXd shapes = noise_shapes(5, 70);
  const Permutations orders = random_permutations(together, 300, 2);
  const Design design = design_of("shape ~ g * x");
  Eigen::VectorXd weights = even;
  for (const bool weighted : {false, true}) {
    if (weighted) weights[3] = 0.5;
    for (std::size_t term = 0; term < 3; ++term) {
      const LandmarkTest each = test_landmarks(design, term, shapes, weights, orders);
      for (const Eigen::Index v : {0, 63, 64, 69})
        CHECK(each.p[v] == test_terms(design, shapes.middleRows(3 * v, 3), weights, orders).terms[term].p);
    }
  }
}

TEST_CASE("results are the same for any number of threads and turned shapes give the same sums") {
  const Eigen::MatrixXd shapes = noise_shapes(8, 200);
  const Permutations orders = random_permutations(together, 500, 2);
  const Design design = design_of("shape ~ g + x");
  const LandmarkTest all = test_landmarks(design, 0, shapes, even, orders);
  const LinearTest terms = test_terms(design, shapes, even, orders);
  {
    const ThreadLimit one(1);
    CHECK(test_landmarks(design, 0, shapes, even, orders).p == all.p);
    CHECK(test_terms(design, shapes, even, orders).terms[1].z == terms.terms[1].z);
  }
  Eigen::MatrixXd turned = shapes;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (Eigen::Index v = 0; v < 200; ++v) turned.middleRows(3 * v, 3) = turn * shapes.middleRows(3 * v, 3);
  CHECK(near(test_terms(design, turned, even, orders).terms[0].f, terms.terms[0].f));
}

TEST_CASE("an effect is the way between the groups with the other terms held") {
  Eigen::MatrixXd shapes = 0.001 * noise_shapes(4, 3);
  Eigen::VectorXd x(10);
  x << 1, 4, 2, 8, 5, 7, 3, 9, 6, 2;
  for (Eigen::Index k = 0; k < 10; ++k) {
    shapes(0, k) += 0.5 * x[k];                                         // vertex 0: x alone
    if (groups[static_cast<std::size_t>(k)] == "b") shapes(4, k) += 3;  // vertex 1: 3 mm against both others
  }
  const Design design = design_of("shape ~ g + x");
  const Permutations orders = random_permutations(together, 99, 2);
  const LandmarkTest by_group = test_landmarks(design, 0, shapes, even, orders);
  CHECK(by_group.effect[1] == doctest::Approx(3).epsilon(0.001));
  CHECK(by_group.effect[0] < 0.01);
  CHECK(by_group.offset.size() == 0);
  const double deviation = std::sqrt((x.array() - x.mean()).square().sum() / 9);
  const LandmarkTest by_x = test_landmarks(design, 1, shapes, even, orders);
  CHECK(by_x.effect[0] == doctest::Approx(0.5 * deviation).epsilon(0.001));
  CHECK(by_x.offset(0, 0) == doctest::Approx(0.5 * deviation).epsilon(0.001));
  const LinearTest whole = test_terms(design, shapes, even, orders);
  REQUIRE(whole.pairs.size() == 3);
  CHECK(whole.pairs[0].distance == doctest::Approx(3).epsilon(0.001));
  CHECK(whole.pairs[1].distance < 0.01);
  CHECK(whole.pairs[0].p == 0.01);
}

TEST_CASE("of two groups the pair has the p of the term") {
  const Eigen::MatrixXd shapes = noise_shapes(11, 4);
  const auto code = [](const Variable& variable) -> Result<CodedVariable> {
    if (variable.name == "g") return coded_groups("g", {"a", "b", "a", "a", "b", "a", "a", "b", "b", "a"});
    return coded_numbers("x", Eigen::VectorXd::LinSpaced(10, 0, 1).cwiseAbs2());
  };
  const Design design = test::must(make_design(test::must(read_formula("shape ~ x + g")).terms, 0, code));
  const LinearTest test = test_terms(design, shapes, even, random_permutations(together, 499, 3));
  CHECK(test.pairs[0].p == test.terms[1].p);
}

TEST_CASE("false discovery rates are those of R") {
  // p.adjust(c(0.01, 0.04, 0.03, 0.005, 0.5), "BH")
  Eigen::VectorXd p(5), q(5);
  p << 0.01, 0.04, 0.03, 0.005, 0.5;
  q << 0.025, 0.05, 0.05, 0.025, 0.5;
  CHECK(false_discovery_rates(p).isApprox(q, 1e-12));
}

TEST_CASE("parallel analysis finds the modes that were put in") {
  Random random(6);
  Eigen::MatrixXd shapes = Eigen::MatrixXd::NullaryExpr(90, 40, [&] { return random.normal(); });
  CHECK(modes_above_chance(shapes, 1) <= 1);
  for (int mode = 0; mode < 3; ++mode) {
    const Eigen::VectorXd axis = Eigen::VectorXd::NullaryExpr(90, [&] { return random.normal(); });
    const Eigen::RowVectorXd scores = Eigen::RowVectorXd::NullaryExpr(40, [&] { return random.normal(); });
    shapes += axis * scores * (3 - 0.5 * mode);
  }
  CHECK(modes_above_chance(shapes, 1) == 3);
}

}  // namespace homolog
