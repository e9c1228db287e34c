#include "core/model/shape_model.h"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <limits>

#include "core/measure/compare.h"
#include "core/model/measures/evaluation.h"
#include "core/model/measures/leave_one_out.h"
#include "core/model/measures/measures.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

/// Shapes that differ by noise everywhere: nothing about them is special.
ShapeMatrix random_shapes(Eigen::Index landmarks, Eigen::Index shapes, unsigned seed = 1) {
  std::srand(seed);
  const Eigen::VectorXd middle = 30 * Eigen::VectorXd::Random(3 * landmarks);
  return (4 * ShapeMatrix::Random(3 * landmarks, shapes)).colwise() + middle;
}

ShapeMatrix without(const ShapeMatrix& shapes, Eigen::Index left_out) {
  ShapeMatrix rest(shapes.rows(), shapes.cols() - 1);
  rest << shapes.leftCols(left_out), shapes.rightCols(shapes.cols() - 1 - left_out);
  return rest;
}

/// Variances and axes by the covariance itself, the smallest first.
Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> direct_components(const ShapeMatrix& shapes) {
  const Eigen::MatrixXd centred = shapes.colwise() - shapes.rowwise().mean();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(centred * centred.transpose() /
                                                        static_cast<double>(shapes.cols() - 1));
}

/// The shape minus its reconstruction by `modes` modes of a model of the others, from scratch.
Eigen::VectorXd direct_error(const ShapeMatrix& shapes, Eigen::Index left_out, Eigen::Index modes) {
  const ShapeMatrix rest = without(shapes, left_out);
  const Eigen::VectorXd mean = rest.rowwise().mean();
  const Eigen::MatrixXd centred = rest.colwise() - mean;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> gram(centred.transpose() * centred);
  const Eigen::MatrixXd axes = (centred * gram.eigenvectors().rightCols(modes)).colwise().normalized();
  const Eigen::VectorXd y = shapes.col(left_out) - mean;
  return y - axes * (axes.transpose() * y);
}

double rms(const Eigen::VectorXd& difference) {
  return difference.norm() / std::sqrt(static_cast<double>(difference.size()) / 3);
}

double mean_length(const Eigen::VectorXd& difference) {
  return points_of(difference).rowwise().norm().mean();
}

template <class Distance>
Measured direct_generalisation(const ShapeMatrix& shapes, Eigen::Index modes, const Distance& distance) {
  Eigen::VectorXd distances(shapes.cols());
  for (Eigen::Index i = 0; i < shapes.cols(); ++i) distances[i] = distance(direct_error(shapes, i, modes));
  return measured(distances);
}

template <class Distance>
Measured direct_specificity(const ShapeMatrix& shapes, const PrincipalComponents& components, const Eigen::MatrixXd& b,
                            Eigen::Index modes, const Distance& distance) {
  Eigen::VectorXd nearest(b.cols());
  const Eigen::MatrixXd basis = components.basis(modes);
  for (Eigen::Index k = 0; k < b.cols(); ++k) {
    const Eigen::VectorXd sample = components.mean + basis * b.col(k).head(modes);
    nearest[k] = std::numeric_limits<double>::infinity();
    for (Eigen::Index j = 0; j < shapes.cols(); ++j)
      nearest[k] = std::min(nearest[k], distance(sample - shapes.col(j)));
  }
  return measured(nearest);
}

void check_equal(const Measured& a, const Measured& b) {
  INFO(a.mean << " and " << b.mean);
  CHECK(std::abs(a.mean - b.mean) < 1e-9);
  CHECK(std::abs(a.standard_error - b.standard_error) < 1e-9);
}

void check_equal(const Measures& a, const Measures& b, double tolerance) {
  REQUIRE(a.size() == b.size());
  for (std::size_t m = 0; m < a.size(); ++m) {
    CHECK(std::abs(a[m].mean - b[m].mean) < tolerance);
    CHECK(std::abs(a[m].standard_error - b[m].standard_error) < tolerance);
  }
}

Similarity some_pose(int k) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(0.7 * k + 0.3, Vec3(1, k, 2).normalized())), 1 + 0.2 * k,
          Vec3(10 * k, -30, 5 * k)};
}

/// Smooth variations of a ball: what real organs look like to the model.
ShapeMatrix smooth_shapes(int count) {
  const Mesh ball = icosphere(3, 40);
  ShapeMatrix shapes(ball.points.size(), count);
  for (int k = 0; k < count; ++k) {
    Points points = ball.points;
    points.col(0) *= 1 + 0.2 * std::sin(k);
    points.col(1) += 0.003 * std::cos(2.0 * k) * points.col(2).cwiseAbs2();
    points.col(2) += 0.1 * std::sin(3.0 * k) * points.col(0);
    shapes.col(k) = Eigen::Map<const Eigen::VectorXd>(points.data(), points.size());
  }
  return shapes;
}

}  // namespace

TEST_CASE("alignment takes out exactly the poses that were put in") {
  const Mesh ball = shapes::torus(12, 8, 20, 7);
  ShapeMatrix posed(ball.points.size(), 5);
  for (int k = 0; k < 5; ++k) {
    const Points points = some_pose(k).apply(ball.points);
    posed.col(k) = Eigen::Map<const Eigen::VectorXd>(points.data(), points.size());
  }
  align(posed, Alignment::similarity);
  for (Eigen::Index k = 1; k < 5; ++k) CHECK((posed.col(k) - posed.col(0)).norm() < 1e-9);
  CHECK(centroid_size_mm(points_of(posed, 0)) == doctest::Approx(1.4 * centroid_size_mm(ball.points)));
}

TEST_CASE("alignment that keeps scale leaves every centroid size as it is") {
  ShapeMatrix shapes = random_shapes(20, 4);
  shapes.col(2) *= 3;
  std::vector<double> sizes;
  for (Eigen::Index k = 0; k < 4; ++k) sizes.push_back(centroid_size_mm(points_of(shapes, k)));
  ShapeMatrix rigid = shapes;
  align(rigid, Alignment::rigid);
  for (Eigen::Index k = 0; k < 4; ++k)
    CHECK(centroid_size_mm(points_of(rigid, k)) == doctest::Approx(sizes[static_cast<std::size_t>(k)]));
  ShapeMatrix untouched = shapes;
  align(untouched, Alignment::none);
  CHECK(untouched == shapes);
}

TEST_CASE("no rotation of one aligned shape brings it nearer to the mean") {
  ShapeMatrix shapes = random_shapes(15, 6);
  align(shapes, Alignment::similarity);
  const Eigen::VectorXd mean = shapes.rowwise().mean();
  for (Eigen::Index k = 0; k < shapes.cols(); ++k) {
    const double best = (points_of(shapes, k) - points_of(mean)).norm();
    for (int axis = 0; axis < 3; ++axis)
      for (const double angle : {-0.01, 0.01}) {
        const Mat3 turn = Eigen::AngleAxisd(angle, Vec3::Unit(axis)).toRotationMatrix();
        CHECK((points_of(shapes, k) * turn - points_of(mean)).norm() > best);
      }
  }
}

TEST_CASE("a mirror image gains from a reflection and a copy loses by it") {
  const Points shape = points_of(random_shapes(20, 1), 0);
  Points mirrored = shape;
  mirrored.col(1) *= -1;
  CHECK(reflection_gain(shape, some_pose(2).apply(mirrored)) > 1000);
  CHECK(reflection_gain(shape, some_pose(3).apply(shape)) < 0.001);
}

TEST_CASE("a mode is gone along by its own deviations") {
  const ShapeModel model = make_model(principal_components(random_shapes(12, 6)), 1, nullptr, {});
  for (const Eigen::Index mode : {0, 3})
    for (const double deviations : {-2.0, 0.5, 3.0}) {
      Eigen::VectorXd b = Eigen::VectorXd::Zero(mode + 1);
      b[mode] = deviations * std::sqrt(model.variances[mode]);
      CHECK((mode_shape(model, mode, deviations) - shape_of(model, b)).norm() < 1e-9);
      CHECK(coefficients(model, mode_shape(model, mode, deviations))[mode] == doctest::Approx(b[mode]));
    }
}

TEST_CASE("the Gram matrix gives the components that the covariance would give") {
  const ShapeMatrix shapes = random_shapes(9, 6);
  const PrincipalComponents components = principal_components(shapes);
  const auto direct = direct_components(shapes);
  REQUIRE(components.scatter.size() == 5);
  for (Eigen::Index k = 0; k < 5; ++k) {
    CHECK(std::abs(components.variances()[k] - direct.eigenvalues()[26 - k]) < 1e-9);
    CHECK(std::abs(components.basis(5).col(k).dot(direct.eigenvectors().col(26 - k))) == doctest::Approx(1));
  }
  CHECK((components.basis(5).transpose() * components.basis(5) - Eigen::MatrixXd::Identity(5, 5)).norm() < 1e-12);
}

TEST_CASE("of more shapes than coordinates the components are those of the covariance too") {
  const ShapeMatrix shapes = random_shapes(4, 40);
  const PrincipalComponents components = principal_components(shapes);
  const auto direct = direct_components(shapes);
  REQUIRE(components.scatter.size() == 12);
  REQUIRE(components.variances().size() == 39);
  for (Eigen::Index k = 0; k < 12; ++k) {
    CHECK(std::abs(components.variances()[k] - direct.eigenvalues()[11 - k]) < 1e-9);
    CHECK(std::abs(components.basis(12).col(k).dot(direct.eigenvectors().col(11 - k))) == doctest::Approx(1));
  }
  CHECK(components.variances().tail(27).isZero(0));
  CHECK((components.basis(12) * components.scores() - components.centred).cwiseAbs().maxCoeff() < 1e-9);
}

TEST_CASE("leading components are the first of all, and know how much lies beyond them") {
  // More coordinates than shapes, and fewer.
  for (const auto& [landmarks, count, leading] : {std::tuple(300, 700, 20), {220, 900, 12}}) {
    ShapeMatrix shapes = random_shapes(landmarks, count);
    // Strengths that fall as an organ's do, so that the axes are told apart.
    const ShapeMatrix waves = random_shapes(landmarks, 30, 2), strengths = random_shapes(10, count, 3);
    for (Eigen::Index k = 0; k < 30; ++k) shapes += waves.col(k) * strengths.row(k) / (1 + k);
    const PrincipalComponents all = principal_components(shapes), some = leading_components(shapes, leading);
    CAPTURE(landmarks);
    REQUIRE(some.scatter.size() == leading);
    CHECK(some.variances().size() == leading);
    CHECK((some.scatter - all.scatter.head(leading)).cwiseAbs().maxCoeff() < 1e-9 * all.scatter[0]);
    CHECK(some.total_variance() == doctest::Approx(all.total_variance()).epsilon(1e-12));
    CHECK(some.total_variance() == doctest::Approx(all.variances().sum()).epsilon(1e-12));
    const Eigen::MatrixXd overlap = some.basis(leading).transpose() * all.basis(leading);
    CHECK((overlap.cwiseAbs() - Eigen::MatrixXd::Identity(leading, leading)).cwiseAbs().maxCoeff() < 1e-6);
    CHECK(model_of_modes(some, leading, nullptr, {}).modes() == leading);
    // How far a shape lies from the others' model, in as many modes.
    const Eigen::VectorXd near = left_out_distances(some, leading), exact = left_out_distances(all, leading);
    const Eigen::ArrayXd off = ((near - exact).array() / exact.array()).abs();
    CAPTURE(off.mean());
    CHECK(off.maxCoeff() < 0.08);  // 0.15 where the rest counted as nothing
    CHECK(off.mean() < 0.012);
    CHECK_THROWS_AS(LeaveOneOut(some, 0).squared_errors(leading), std::invalid_argument);
    CHECK_THROWS_AS(compactness(some), std::invalid_argument);
    CHECK(leading_components(shapes, leading).vectors == some.vectors);
  }
  // Few shapes: all components are known as soon.
  const ShapeMatrix few = random_shapes(9, 6);
  CHECK(leading_components(few, 2).beyond == 0);
  CHECK(leading_components(few, 2).vectors == principal_components(few).vectors);
}

TEST_CASE("a model with all modes rebuilds each of its training shapes") {
  const ShapeMatrix shapes = random_shapes(30, 7);
  const ShapeModel model = make_model(principal_components(shapes), 1, nullptr, {});
  CHECK(model.modes() == 6);
  for (Eigen::Index i = 0; i < shapes.cols(); ++i) {
    const Points shape = points_of(shapes, i);
    CHECK((shape_of(model, coefficients(model, shape)) - shape).cwiseAbs().maxCoeff() < 1e-9);
    CHECK((model.scores.col(i) - coefficients(model, shape)).cwiseAbs().maxCoeff() < 1e-9);
  }
}

TEST_CASE("the share of variance decides how many modes a model has") {
  Eigen::VectorXd variances(4);
  variances << 70, 20, 8, 2;
  CHECK(modes_holding(variances, 0.5) == 1);
  CHECK(modes_holding(variances, 0.7) == 1);
  CHECK(modes_holding(variances, 0.9) == 2);
  CHECK(modes_holding(variances, 0.95) == 3);
  CHECK(modes_holding(variances, 1) == 4);
  CHECK(modes_holding(Eigen::VectorXd::Zero(3), 0.95) == 0);
  // What numbers in single precision leave over is no mode.
  variances << 70, 20, 2e-6, 1e-6;
  CHECK(modes_holding(variances, 1) == 2);
}

TEST_CASE("coefficients are held within three deviations") {
  const ShapeModel model = make_model(principal_components(random_shapes(10, 5)), 1, nullptr, {});
  const Eigen::VectorXd far = 100 * Eigen::VectorXd::Ones(4);
  CHECK((clamped(model, far) - 3 * model.variances.cwiseSqrt()).norm() < 1e-12);
  CHECK((clamped(model, -far) + 3 * model.variances.cwiseSqrt()).norm() < 1e-12);
  CHECK((mode_shape(model, 1, 0) - points_of(model.mean)).norm() < 1e-12);
  CHECK(sampled_shape(model, 5) == sampled_shape(model, 5));
  CHECK(sampled_shape(model, 5) != sampled_shape(model, 6));
}

TEST_CASE("samples have the variances asked for and fewer modes are their upper rows") {
  Eigen::VectorXd variances(3);
  variances << 9, 4, 1;
  const Eigen::MatrixXd b = sampled_coefficients(variances, 20000, 3);
  for (Eigen::Index k = 0; k < 3; ++k) {
    CHECK(b.row(k).squaredNorm() / 20000 == doctest::Approx(variances[k]).epsilon(0.03));
    CHECK(std::abs(b.row(k).mean()) < 0.05 * std::sqrt(variances[k]));
  }
  CHECK(sampled_coefficients(variances.head(2), 20000, 3) == b.topRows(2));
}

TEST_CASE("compactness rises to the share of all but the last mode") {
  const PrincipalComponents components = principal_components(random_shapes(25, 8));
  const Measures shares = compactness(components);
  REQUIRE(shares.size() == 6);
  for (std::size_t m = 1; m < 6; ++m) CHECK(shares[m].mean > shares[m - 1].mean);
  const Eigen::VectorXd variances = components.variances();
  CHECK(shares.back().mean == doctest::Approx(1 - variances[6] / variances.sum()));
  // d share / d λ₁ = (1 − share) / Σλ, d share / d λ_k = −share / Σλ.
  const double first = variances[0] / variances.sum();
  const double rest_squares = variances.tail(variances.size() - 1).squaredNorm();
  CHECK(shares.front().standard_error ==
        doctest::Approx(
            std::sqrt(2.0 / 8) / variances.sum() *
            std::sqrt((1 - first) * (1 - first) * variances[0] * variances[0] + first * first * rest_squares)));
  CHECK(shares.back().standard_error < shares.front().standard_error);
}

TEST_CASE("a measure is the mean with the error of a sample's mean") {
  const Measured four = measured(Eigen::Vector4d(1, 2, 3, 6));
  CHECK(four.mean == doctest::Approx(3));
  CHECK(four.standard_error == doctest::Approx(std::sqrt((4 + 1 + 0 + 9) / 3.0 / 4)));
  CHECK(measured(Eigen::VectorXd::Constant(1, 5)).mean == 5);
  CHECK(measured(Eigen::VectorXd::Constant(1, 5)).standard_error == 0);
  CHECK(measured(Eigen::VectorXd()).mean == 0);
}

TEST_CASE("measures agree with building every model directly") {
  const ShapeMatrix shapes = random_shapes(40, 9);
  const PrincipalComponents components = principal_components(shapes);
  const Measures general = generalisation_rms(components), specific = specificity_rms(components, 60, 7);
  REQUIRE(general.size() == 7);
  REQUIRE(specific.size() == 7);
  const std::vector<int> modes{1, 2, 3, 4, 5, 6, 7};
  const Measures general_mean = generalisation(components, nullptr, modes).value().mean;
  const Measures specific_mean = specificity_mean(components, modes, 60, 7).value();
  const Measures shapeworks = specificity_mean(components, modes, 60, 7, true).value();
  const Eigen::MatrixXd b = sampled_coefficients(components.variances(), 60, 7);
  const Eigen::MatrixXd b_shapeworks = sampled_coefficients(components.scatter.cwiseSqrt(), 60, 7);
  for (Eigen::Index m = 1; m <= 7; ++m) {
    const auto at = static_cast<std::size_t>(m - 1);
    INFO("modes " << m);
    check_equal(general[at], direct_generalisation(shapes, m, rms));
    check_equal(general_mean[at], direct_generalisation(shapes, m, mean_length));
    check_equal(specific[at], direct_specificity(shapes, components, b, m, rms));
    check_equal(specific_mean[at], direct_specificity(shapes, components, b, m, mean_length));
    check_equal(shapeworks[at], direct_specificity(shapes, components, b_shapeworks, m, mean_length));
  }
}

TEST_CASE("the bound that spares distances changes none of them on smooth shapes") {
  const ShapeMatrix shapes = smooth_shapes(12);
  const PrincipalComponents components = principal_components(shapes);
  const Eigen::MatrixXd b = sampled_coefficients(components.variances().head(3), 50, 2);
  check_equal(specificity_mean(components, {3}, 50, 2).value()[0],
              direct_specificity(shapes, components, b, 3, mean_length));
}

TEST_CASE("leaving one out works where shapes repeat and modes coincide") {
  ShapeMatrix repeated = random_shapes(12, 7);
  repeated.col(3) = repeated.col(1);
  repeated.col(5) = repeated.col(1);
  // Two pairs at equal distances along two axes: equal eigenvalues, and shapes that lie on one axis alone.
  ShapeMatrix crossed = ShapeMatrix::Zero(12, 5);
  crossed(0, 0) = crossed(1, 2) = 2;
  crossed(0, 1) = crossed(1, 3) = -2;
  crossed(5, 4) = 1;
  for (const ShapeMatrix& shapes : {repeated, crossed}) {
    const PrincipalComponents components = principal_components(shapes);
    for (Eigen::Index i = 0; i < shapes.cols(); ++i) {
      const LeaveOneOut left_out(components, i);
      // Where eigenvalues coincide the order of modes is open, so only none and all are compared.
      const Eigen::Index all = shapes.cols() - 2;
      const Eigen::VectorXd squares = left_out.squared_errors(all);
      for (const Eigen::Index m : {Eigen::Index{0}, all}) {
        const Eigen::VectorXd variances = direct_components(without(shapes, i)).eigenvalues();
        const Eigen::Index rank = (variances.array() > 1e-12 * variances.maxCoeff()).count();
        const Eigen::VectorXd direct = direct_error(shapes, i, std::min(m, rank));
        CHECK(std::abs(std::sqrt(squares[m]) - direct.norm()) < 1e-6);
        CHECK((components.basis(components.scatter.size()) * left_out.error(m) - direct).norm() < 1e-6);
      }
    }
  }
}

TEST_CASE("posing the training shapes anew leaves the measures alone") {
  ShapeMatrix shapes = random_shapes(50, 8), posed = shapes;
  for (int k = 0; k < 8; ++k) {
    const Points points = some_pose(k).apply(Points(points_of(shapes, k)));
    posed.col(k) = Eigen::Map<const Eigen::VectorXd>(points.data(), points.size());
  }
  align(shapes, Alignment::similarity);
  align(posed, Alignment::similarity);
  posed *= centroid_size_mm(points_of(shapes, 0)) / centroid_size_mm(points_of(posed, 0));
  const PrincipalComponents a = principal_components(shapes), b = principal_components(posed);
  check_equal(compactness(a), compactness(b), 1e-8);
  check_equal(generalisation_rms(a), generalisation_rms(b), 1e-8);
  check_equal(specificity_rms(a, 100, 1), specificity_rms(b, 100, 1), 1e-8);
}

TEST_CASE("the surface measure is the distance between the rebuilt surface and the shape's") {
  const Mesh ball = icosphere(3, 40);
  const ShapeMatrix shapes = smooth_shapes(6);
  const PrincipalComponents components = principal_components(shapes);
  const Generalisation both = generalisation(components, ball.topology, {2, 3}).value();
  REQUIRE(both.surface.size() == 2);
  const Measured measure = both.surface[0];
  Eigen::VectorXd direct(6);
  for (Eigen::Index i = 0; i < 6; ++i) {
    const Eigen::VectorXd rebuilt = shapes.col(i) - direct_error(shapes, i, 2);
    direct[i] = compare_meshes({ball.topology, points_of(shapes, i)}, {ball.topology, points_of(rebuilt)}).assd_mm;
  }
  check_equal(measure, measured(direct));
  CHECK(measure.mean <= both.mean[0].mean);
  // Alone and beside other counts, with faces and without: the same numbers.
  const Generalisation alone = generalisation(components, nullptr, {3}).value();
  CHECK(alone.mean[0].mean == both.mean[1].mean);
  CHECK(alone.surface.empty());
  CHECK(generalisation(components, ball.topology, {2}).value().surface[0].mean == measure.mean);
}

TEST_CASE("measures of two shapes and of more modes than there are measures for are refused") {
  CHECK(!evaluate_model(principal_components(random_shapes(25, 2)), nullptr, {{0}}));
  const PrincipalComponents components = principal_components(random_shapes(25, 5));
  CHECK(!evaluate_model(components, nullptr, {{4}}));
  CHECK(!evaluate_model(components, nullptr, {{-1}}));
  CHECK(evaluate_model(components, nullptr, {{3}}));
}

TEST_CASE("a stopped measure says so") {
  const PrincipalComponents components = principal_components(random_shapes(10, 5));
  Progress progress;
  progress.cancel();
  CHECK(!generalisation(components, nullptr, {1}, &progress));
  CHECK(!specificity_mean(components, {1}, 10, 1, false, &progress));
  CHECK(!generalisation(components, icosphere(0, 1).topology, {1}, &progress));
}
