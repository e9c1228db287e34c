#include "core/placement/relative_pose.h"

#include <doctest/doctest.h>

#include <numbers>
#include <random>

#include "core/mesh/construction/icosphere.h"

namespace homolog {

namespace {

Similarity turned(double degrees, const Vec3& axis, double scale, const Vec3& translation) {
  const Eigen::AngleAxisd turn(degrees * std::numbers::pi / 180, axis.normalized());
  return {Eigen::Quaterniond(turn), scale, translation};
}

Points eggs_at(const Vec3& place) {
  Points points = icosphere(2, 10).points;
  points.col(0) *= 1.5;
  points.col(1) *= 0.7;
  return points.rowwise() + place.transpose();
}

double farthest_mm(const Points& a, const Points& b) {
  return (a - b).rowwise().norm().maxCoeff();
}

}  // namespace

TEST_CASE("the pose of one subject is where it lies and has no spread") {
  const Vec3 middle(10, 0, 0);
  const RelativePose pose = relative_pose({turned(20, Vec3::UnitZ(), 1.1, Vec3(0, 0, 3))}, middle);
  CHECK(pose.subjects == 1);
  CHECK((pose.turn_deg - Vec3(0, 0, 20)).norm() < 1e-9);
  CHECK(pose.scale == doctest::Approx(1.1));
  CHECK(pose.offset_mm.z() == doctest::Approx(3));
  CHECK(pose.offset_sd_mm == 0);
}

TEST_CASE("the spread of poses is that of their offsets, turns and scales") {
  // About the middle itself: turned by ±10 degrees, moved by ±2 mm, scaled by 0.9 and 1/0.9.
  const auto about = [](double degrees, double scale, const Vec3& offset) {
    return turned(degrees, Vec3::UnitX(), scale, offset);
  };
  const RelativePose pose =
      relative_pose({about(10, 0.9, Vec3(2, 0, 0)), about(-10, 1 / 0.9, Vec3(-2, 0, 0))}, Vec3::Zero());
  CHECK(pose.subjects == 2);
  CHECK(pose.offset_mm.norm() < 1e-9);
  CHECK(pose.turn_deg.norm() < 1e-6);
  CHECK(pose.scale == doctest::Approx(1));
  CHECK(pose.offset_sd_mm == doctest::Approx(std::sqrt(8)));
  CHECK(pose.turn_sd_deg == doctest::Approx(std::sqrt(200)));
  CHECK(pose.scale_sd == doctest::Approx(std::sqrt(0.01 + std::pow(1 / 0.9 - 1, 2))));
}

TEST_CASE("mean places bring subjects together whatever lies where, and do not depend on their order") {
  const std::vector<Points> templates{eggs_at(Vec3::Zero()), eggs_at(Vec3::Zero()), eggs_at(Vec3::Zero()),
                                      eggs_at(Vec3::Zero())};
  const std::vector<Similarity> truth{turned(5, Vec3(1, 2, 0), 1, Vec3(-60, 0, 0)),
                                      turned(-9, Vec3(0, 1, 1), 1.1, Vec3(0, 5, 0)),
                                      turned(0, Vec3::UnitX(), 0.8, Vec3(50, 0, 20)), Similarity{}};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> some(-1, 1);
  std::vector<std::vector<std::optional<Similarity>>> placed;
  for (int s = 0; s < 5; ++s) {
    const Similarity subject = turned(30 * some(random), Vec3(some(random), some(random), 1), 1 + 0.2 * some(random),
                                      100 * Vec3(some(random), some(random), some(random)));
    placed.emplace_back();
    for (std::size_t k = 0; k < templates.size(); ++k) placed.back().push_back(subject.after(truth[k]));
    placed.back()[3].reset();                                           // it is nowhere
    if (s > 0) placed.back()[static_cast<std::size_t>(s) % 3].reset();  // one is missing
  }
  const auto places = mean_places(templates, placed);
  REQUIRE(places.size() == 4);
  CHECK(places[3] == Similarity{});
  // They lie to each other as in the truth, up to one similarity of all.
  const Similarity common = places[0].after(truth[0].inverse());
  for (std::size_t k = 0; k < 3; ++k) {
    CAPTURE(k);
    CHECK(farthest_mm(places[k].apply(templates[k]), common.after(truth[k]).apply(templates[k])) < 1e-3);
  }
  std::swap(placed[0], placed[4]);
  std::swap(placed[1], placed[2]);
  const auto again = mean_places(templates, placed);
  for (std::size_t k = 0; k < 3; ++k)
    CHECK(farthest_mm(places[k].apply(templates[k]), again[k].apply(templates[k])) < 1e-4);
}

}  // namespace homolog
