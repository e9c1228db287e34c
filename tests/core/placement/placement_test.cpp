#include <doctest/doctest.h>

#include <numbers>

#include "core/placement/known_matches.h"
#include "core/placement/landmark_warp.h"
#include "core/placement/likely_similarity.h"
#include "core/placement/similarity_fit.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

Points rows(std::initializer_list<Vec3> points) {
  Points all(static_cast<Eigen::Index>(points.size()), 3);
  Eigen::Index i = 0;
  for (const Vec3& p : points) all.row(i++) = p.transpose();
  return all;
}

constexpr double degree = std::numbers::pi / 180;
const Similarity moved{Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized())), 1.3, Vec3(10, -20, 30)};
const Points corners = rows({{0, 0, 50}, {0, 0, -50}, {30, 5, 0}, {-25, 0, 10}, {0, 20, -5}});

}  // namespace

TEST_CASE("a similarity composes with its inverse to the identity") {
  CHECK(largest_difference(moved.inverse().apply(moved.apply(corners)), corners) < 1e-12);
  CHECK(largest_difference(moved.after(moved).apply(corners), moved.apply(moved.apply(corners))) < 1e-11);
}

TEST_CASE("three or more landmarks recover the similarity exactly") {
  for (const Eigen::Index n : {3, 4, 5}) {
    const Similarity fitted = nearest_similarity(corners.topRows(n), moved.apply(corners.topRows(n).eval()), {});
    CHECK(largest_difference(fitted.apply(corners), moved.apply(corners)) < 1e-9);
  }
}

TEST_CASE("mirrored landmarks never make a reflection") {
  Points mirrored = corners;
  mirrored.col(0) *= -1;
  const Similarity fitted = nearest_similarity(corners, mirrored, {});
  CHECK(fitted.scale > 0);
  // No proper rotation reaches a mirror image; the best one found is no worse than many others.
  const auto off = [&](const Similarity& s) { return (s.apply(corners) - mirrored).squaredNorm(); };
  CHECK(off(fitted) > 100);
  for (int k = 0; k < 200; ++k) {
    Similarity other = fitted;
    const Vec3 axis(std::sin(k), std::cos(2 * k), std::sin(3 * k + 1));
    other.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(0.03 * k, axis.normalized()));
    other.translation =
        Vec3(mirrored.colwise().mean()) - other.scale * (other.rotation * Vec3(corners.colwise().mean()));
    CHECK(off(other) >= off(fitted) - 1e-9);
  }
}

TEST_CASE("one landmark translates only") {
  const Similarity fitted = nearest_similarity(corners.topRows(1), rows({{1, 2, 3}}), moved);
  CHECK(fitted.rotation.isApprox(moved.rotation));
  CHECK(fitted.scale == moved.scale);
  CHECK((fitted.apply(Vec3(corners.row(0))) - Vec3(1, 2, 3)).norm() < 1e-12);
}

TEST_CASE("two landmarks scale and turn by the smallest rotation") {
  const Points from = rows({{0, 0, 50}, {0, 0, -50}}), to = rows({{0, 60, 0}, {0, -60, 0}});
  const Similarity fitted = nearest_similarity(from, to, {});
  CHECK(largest_difference(fitted.apply(from), to) < 1e-9);
  CHECK(fitted.scale == doctest::Approx(1.2));
  CHECK((fitted.rotation * Vec3::UnitX() - Vec3::UnitX()).norm() < 1e-9);  // no spin about the line
}

TEST_CASE("collinear landmarks leave the spin as it is") {
  const Points from = rows({{0, 0, 50}, {0, 0, 0}, {0, 0, -50}});
  const Similarity spun{Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Vec3::UnitZ())), 1, Vec3::Zero()};
  const Similarity fitted = nearest_similarity(from, Points(from.rowwise() + Eigen::RowVector3d(5, 5, 5)), spun);
  CHECK(fitted.rotation.angularDistance(spun.rotation) < 1e-9);
}

TEST_CASE("landmarks decide of a rotation what they determine well and nothing else") {
  const double diagonal_mm = 120, turn = 20 * degree;
  const PlacementPrior prior{
      {Eigen::Quaterniond(Eigen::AngleAxisd(0.1, Vec3(1, 1, 1).normalized())), 1.1, Vec3(4, 5, 6)}};
  const Similarity tilted{Eigen::Quaterniond(Eigen::AngleAxisd(turn, Vec3::UnitX())) * prior.around.rotation, 1.1, {}};
  const Similarity spun{prior.around.rotation * Eigen::AngleAxisd(turn, Vec3::UnitZ()), 1.1, {}};
  const auto found = [&](const Points& from, const Similarity& truth) {
    return likely_similarity(from, truth.apply(from), prior, diagonal_mm).rotation.angularDistance(truth.rotation);
  };
  // Spread widely, and along a line: what turns the line is seen, what spins it is not.
  CHECK(found(corners, tilted) < 0.1 * turn);
  CHECK(found(corners, spun) < 0.3 * turn);
  const Points line = rows({{0, 0, 50}, {3, 0, 0}, {0, 0, -50}});
  CHECK(found(line, tilted) < 0.1 * turn);
  CHECK(found(line, spun) > 0.95 * turn);
  // Nearly on a line, the middle one 6 mm off: the closed form spins by half a turn.
  Points clicked = prior.around.apply(line);
  clicked.row(1) -= 6 * (prior.around.rotation * Vec3::UnitX()).transpose();
  CHECK(nearest_similarity(line, clicked, prior.around).rotation.angularDistance(prior.around.rotation) > 2);
  CHECK(likely_similarity(line, clicked, prior, diagonal_mm).rotation.angularDistance(prior.around.rotation) <
        1 * degree);
}

TEST_CASE("landmarks that are few or lie together place as far as they know") {
  const PlacementPrior prior{moved};
  const double diagonal_mm = 120;
  CHECK(likely_similarity(Points(0, 3), Points(0, 3), prior, diagonal_mm) == moved);
  const Similarity one = likely_similarity(corners.topRows(1), rows({{1, 2, 3}}), prior, diagonal_mm);
  CHECK(one.rotation.angularDistance(moved.rotation) < 1e-7);
  CHECK(one.scale == doctest::Approx(moved.scale));
  CHECK((one.apply(Vec3(corners.row(0))) - Vec3(1, 2, 3)).norm() < 1e-9);
  // Three within some mm, clicked in the wrong order: neither turned nor shrunk.
  const Points near = rows({{0, 0, 50}, {2, 0, 50}, {0, 2, 50}});
  const Points there = moved.apply(Points(near(Eigen::Vector3i(1, 2, 0), Eigen::all)));
  const Similarity together = likely_similarity(near, there, prior, diagonal_mm);
  CHECK(together.rotation.angularDistance(moved.rotation) < 1 * degree);
  CHECK(together.scale == doctest::Approx(moved.scale).epsilon(0.1));
  // Two turn by the smallest rotation, nearly as far as they ask for, and scale.
  const Points ends = rows({{0, 0, 50}, {0, 0, -50}});
  const Similarity two = likely_similarity(ends, rows({{0, 0, 60}, {0, 6, -60}}), {}, diagonal_mm);
  CHECK((two.apply(ends) - rows({{0, 0, 60}, {0, 6, -60}})).norm() < 2);
  CHECK((two.rotation * Vec3::UnitX() - Vec3::UnitX()).norm() < 1e-9);
}

TEST_CASE("the warp brings landmarks close and is nothing where they meet already") {
  CHECK(largest_difference(LandmarkWarp(corners, corners, {50, 6, 0.7}).apply(corners), corners) < 1e-12);
  Points to = corners;
  to.row(2) += Eigen::RowVector3d(5, 0, 0);
  to.row(4) += Eigen::RowVector3d(0, -4, 0);
  const double left = (LandmarkWarp(corners, to, {50, 6, 0.7}).apply(corners) - to).rowwise().norm().maxCoeff();
  CHECK(left < 1);
}

TEST_CASE("four near-coplanar landmarks with some error do not stretch space") {
  const Points from = rows({{40, 0, 0.5}, {-40, 0, -0.5}, {0, 40, 0.3}, {0, -40, -0.2}});
  Points to = from;
  to.col(2) += Eigen::Vector4d(3, -3, -3, 3);
  const LandmarkWarp warp(from, to, {50, 6, 0.7});
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(20, 10, 30), Vec3(-30, 20, -30), Vec3(40, 0, 0)}) {
    const Points probe = rows({p, p + Vec3(0, 0, 1), p + Vec3(1, 0, 0), p + Vec3(0, 1, 0)});
    const Points warped = warp.apply(probe);
    for (int axis = 1; axis < 4; ++axis) {
      const double stretch = (warped.row(axis) - warped.row(0)).norm();
      CHECK(stretch > 0.85);
      CHECK(stretch < 1.15);
    }
  }
}

TEST_CASE("landmarks that contradict each other are believed less") {
  // A smooth bend of a ball of 100 mm is what organs do. Jumps between neighbours are noise.
  const Points placed = icosphere(2, 50).points;
  const Points from = placed(Eigen::seqN(0, 24, placed.rows() / 24), Eigen::all);
  Points bent = from;
  bent.col(0) += (4 * (from.col(2) / 40).array().sin()).matrix();
  const VertexScalars trusted = VertexScalars::Ones(24);
  const double clicked_mm = warp_lengths(bounds_of(placed).diagonal().norm()).noise_mm;
  const auto noise_mm = [&](const Points& to) { return known_matches(placed, from, to, trusted).noise_mm; };
  CHECK(noise_mm(bent) == clicked_mm * trusted);
  double before_mm = clicked_mm;
  for (const double off_mm : {2.5, 5.0}) {
    Points to = bent;
    for (Eigen::Index i = 0; i < to.rows(); ++i)
      for (int axis = 0; axis < 3; ++axis) to(i, axis) += off_mm * std::sin(7 * i + 40 * axis) * std::sqrt(2);
    const double found_mm = noise_mm(to)[0];
    CHECK(found_mm > before_mm);
    CHECK(found_mm > off_mm / 2);
    CHECK(found_mm < off_mm * 2);
    before_mm = found_mm;
  }
  VertexScalars one_doubted = trusted;
  one_doubted[3] = 0;
  const KnownMatches known = known_matches(placed, from, bent, one_doubted);
  CHECK(known.noise_mm[3] > 100 * known.noise_mm[2]);
  // One or two cannot contradict each other, however far off they are.
  for (const Eigen::Index few : {1, 2}) {
    const Points there = from.topRows(few).array() + 40;
    CHECK(known_matches(placed, from.topRows(few), there, trusted.head(few)).noise_mm ==
          clicked_mm * trusted.head(few));
  }
  CHECK(known_matches(placed, Points(0, 3), Points(0, 3), VertexScalars(0)).noise_mm.size() == 0);
}

TEST_CASE("the lengths of a warp and its kernel are those of the organ's size") {
  const WarpLengths lengths = warp_lengths(200);
  CHECK(lengths.reach_mm == doctest::Approx(50));
  CHECK(lengths.bump_mm == doctest::Approx(9));
  CHECK(lengths.noise_mm == doctest::Approx(1));
  CHECK(older_warp_lengths(200).reach_mm == doctest::Approx(50));
  CHECK(older_warp_lengths(200).bump_mm == 6);
  CHECK(older_warp_lengths(200).noise_mm == 0.7);
  const WarpKernel kernel(Eigen::RowVector3d(0, 0, 10), {50, 9, 1});
  const Points from = rows({{0, 0, 10}, {30, 0, 10}}), to = rows({{0, 0, 10}, {30, 40, 10}});
  const Eigen::MatrixXd found = kernel(from, to);
  CHECK(found(0, 0) == doctest::Approx(81));
  CHECK(found(0, 1) == doctest::Approx(81 * std::exp(-0.5)));  // one reach away
  CHECK(found(1, 1) == doctest::Approx(81 * std::exp(-0.5 * 0.64) + 0.0009 * 900));
}

TEST_CASE("landmarks decide of the size by how far they spread over their error") {
  const PlacementPrior prior;
  const double diagonal_mm = 100, noise_mm = 4.5;  // the error of a landmark is that share of the diagonal
  for (const double half_mm : {2.0, 10.0, 50.0}) {
    const Points from = rows({{0, 0, half_mm}, {0, 0, -half_mm}});
    const double spread = 2 * half_mm * half_mm / (noise_mm * noise_mm), before = 1 / (0.5 * 0.5);
    const double scale = likely_similarity(from, 1.3 * from, prior, diagonal_mm).scale;
    CHECK(scale == doctest::Approx((1.3 * spread + before) / (spread + before)));
  }
  // Larger and smaller by the same factor are both found.
  const Points wide = 100 * corners;
  CHECK(likely_similarity(wide, 2 * wide, prior, diagonal_mm).scale == doctest::Approx(2).epsilon(0.001));
  CHECK(likely_similarity(wide, 0.5 * wide, prior, diagonal_mm).scale == doctest::Approx(0.5).epsilon(0.001));
}

TEST_CASE("two landmarks keep their order") {
  const Points from = rows({{0, 0, 50}, {0, 0, -50}});
  for (const Vec3& first : {Vec3(3, 4, 60), Vec3(0, 1, -40), Vec3(20, 0, 1)}) {
    const Points to = rows({first, -first});
    CHECK(largest_difference(nearest_similarity(from, to, {}).apply(from), to) < 1e-9);
  }
}

TEST_CASE("three landmarks warp nothing and four do") {
  const Mesh ball = icosphere(2, 40);
  const Points from = rows({{0, 0, 40}, {0, 0, -40}, {40, 0, 0}, {0, 40, 0}});
  Points to = from;
  to.row(2) += Eigen::RowVector3d(4, 0, 0);
  const WarpLengths lengths = warp_lengths(130);
  const WarpedReference three = warp_to_landmarks(*ball.topology, ball.points, from.topRows(3), to.topRows(3), lengths);
  CHECK(three.share == 0);
  CHECK(three.points == ball.points);
  const WarpedReference four = warp_to_landmarks(*ball.topology, ball.points, from, to, lengths);
  CHECK(four.share == 1);
  CHECK_FALSE(four.folds);
  CHECK((four.points - ball.points).col(0).maxCoeff() > 2);
  CHECK((four.points - ball.points).col(0).minCoeff() > -1.5);
}
