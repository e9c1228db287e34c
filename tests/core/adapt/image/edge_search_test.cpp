#include "core/adapt/image/edge_search.h"

#include <doctest/doctest.h>

#include <cmath>

#include "core/adapt/image/tissue.h"
#include "tests/shapes.h"

// Which of several edges a snap takes, and where between two voxels it is.

namespace homolog {

namespace {

/// The intensity at a distance from the middle, blurred by half a voxel.
struct Shells {
  struct Edge {
    double radius_mm, contrast;  ///< within less without
  };
  std::vector<Edge> edges;
  double outside = 0;

  Volume image(double spacing_mm = 2) const {
    constexpr int size = 54;
    Volume volume;
    volume.geometry.dims = {size, size, size};
    volume.geometry.spacing_mm.setConstant(spacing_mm);
    volume.geometry.origin_mm.setConstant(-spacing_mm * (size - 1) / 2);
    std::vector<float> voxels;
    for (int k = 0; k < size; ++k)
      for (int j = 0; j < size; ++j)
        for (int i = 0; i < size; ++i) {
          const double away_mm = volume.geometry.to_mm(Vec3(i, j, k)).norm();
          double value = outside + (i * 7 + j * 5 + k * 3) % 4;
          for (const Edge& edge : edges) value += edge.contrast / (1 + std::exp((away_mm - edge.radius_mm) / 0.7));
          voxels.push_back(static_cast<float>(value));
        }
    volume.data = std::move(voxels);
    return volume;
  }
  /// How far from the middle the edges lie that a ball finds: the mean.
  double found_mm(double ball_mm, double reach_mm = 10) const {
    const Volume volume = image();
    const Mesh ball = icosphere(3, ball_mm);
    const EdgeSearch search(volume, 0, ball, {.reach_mm = reach_mm});
    const TargetPull pull = search.find(ball, reach_mm);
    CHECK(pull.weights.mean() > 0.3);
    return pull.weights.dot(VertexScalars(pull.targets.rowwise().norm())) / pull.weights.sum();
  }
};

}  // namespace

TEST_CASE("an edge is found to a part of a voxel") {
  const Shells ball{{{30, 100}}};
  for (const double size_mm : {27.0, 29.3, 31.7, 34.0}) CHECK(std::abs(ball.found_mm(size_mm) - 30) < 0.25);
}

TEST_CASE("of two edges alike the nearer one is taken") {
  const Shells alike{{{27, 100}, {31, -100}, {35, 100}}};
  CHECK(std::abs(alike.found_mm(28) - 27) < 1);
  CHECK(std::abs(alike.found_mm(34) - 35) < 1);
}

TEST_CASE("of two places that look as learned the nearer one is taken") {
  const Volume finished = Shells{{{30, 100}}}.image(), image = Shells{{{24, 100}, {32, -100}, {40, 100}}}.image();
  const auto learned = std::make_shared<Appearance>();
  REQUIRE(learned->learn(finished, 0, icosphere(3, 30)));
  const auto found_mm = [&](double ball_mm) {
    const Mesh ball = icosphere(3, ball_mm);
    const EdgeSearch search(image, 0, ball, {.reach_mm = 14, .appearance = learned});
    return search.find(ball, 14).targets.rowwise().norm().mean();
  };
  CHECK(found_mm(29) < 27);
  CHECK(found_mm(35) > 37);
}

TEST_CASE("around an edge that lies elsewhere than its neighbours' nothing is sure") {
  Volume image = Shells{{{30, 100}}}.image();
  auto& voxels = std::get<std::vector<float>>(image.data);
  const auto [columns, rows, slices] = image.geometry.dims;
  std::size_t voxel = 0;
  for (int k = 0; k < slices; ++k)
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i, ++voxel) {
        const Vec3 p = image.geometry.to_mm(Vec3(i, j, k));
        if (p.x() > 0 && std::hypot(p.y(), p.z()) < 6 && p.norm() < 36) voxels[voxel] = 100;  // a thorn of 6 mm
      }
  const Mesh ball = icosphere(3, 30);
  const TargetPull pull = EdgeSearch(image, 0, ball, {.reach_mm = 10}).find(ball, 10);
  Eigen::Index thorn = 0;
  CHECK(ball.points.col(0).maxCoeff(&thorn) > 29.9);
  for (const std::int32_t i : ball.topology->one_ring(thorn)) {
    CHECK(std::abs(pull.targets.row(i).norm() - 36) < 1);
    CHECK(pull.weights[i] < 0.36);
  }
  CHECK(pull.weights.mean() > 0.95);
}

TEST_CASE("an edge within the organ is passed over for the one where its tissue ends") {
  // Brighter within, as a kidney's pelvis may be: foreign tissue lies beyond the outer edge only.
  const Shells organ{{{24, 40}, {30, 100}}};
  CHECK(std::abs(organ.found_mm(28.5) - 30) < 1);
}

TEST_CASE("tissue belongs to the side of the mesh on which it lies") {
  Profiles profiles{Eigen::MatrixXf(41, 20), 1, Points::Zero(20, 3)};
  for (Eigen::Index k = 0; k < 41; ++k)
    for (Eigen::Index i = 0; i < 20; ++i) profiles.values(k, i) = (k < 20 ? 100.0f : 10.0f) + static_cast<float>(i % 5);
  const Tissue tissue(profiles);
  CHECK(tissue.belongs(102) > 0.7f);
  CHECK(tissue.belongs(12) < -0.7f);
  CHECK(std::abs(tissue.belongs(55)) < 0.3f);
  CHECK(tissue.belongs(not_shown) == 0);
}

TEST_CASE("the brighter side is the organ's where its edges are clearly stronger and else either may be") {
  const auto polarity = [](const Shells& shells) {
    const Volume volume = shells.image();
    return EdgeSearch(volume, 0, icosphere(3, 30), {}).polarity();
  };
  CHECK(polarity({{{30, 100}}}) == Polarity::bright_inside);
  CHECK(polarity({{{30, -100}}, 100}) == Polarity::dark_inside);
  CHECK(polarity({{{27, 100}, {33, -100}}, 100}) == Polarity::either);
}

}  // namespace homolog
