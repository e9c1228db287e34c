#include "core/groupwise/suited_template.h"

#include <doctest/doctest.h>

#include <cmath>

#include "core/groupwise/consensus.h"
#include "tests/must.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

/// An egg that grows with its number.
Mesh egg(int number) {
  Mesh mesh = icosphere(3, 40);
  mesh.points.col(2) *= 1.3 + 0.05 * number;
  mesh.points.col(0) += 0.006 * mesh.points.col(1).cwiseAbs2();
  return mesh;
}

}  // namespace

TEST_CASE("the subject in the middle is nearest to the mean and the one at the end is last") {
  std::vector<Boundary> eggs;
  for (const int number : {4, 0, 2, 1, 3}) eggs.push_back(mesh_boundary(egg(number)));
  const auto nearest = test::must(nearest_to_mean(eggs, 5, 300));
  REQUIRE(nearest.size() == 5);
  CHECK(nearest.front() == 2);
  CHECK((nearest.back() == 0 || nearest.back() == 1));
  CHECK(test::must(nearest_to_mean(eggs, 2, 300)).size() == 2);
  Progress cancelled;
  cancelled.cancel();
  CHECK_FALSE(nearest_to_mean(eggs, 2, 300, &cancelled));
}

TEST_CASE("fewer doubtful fits suit better and of as many the nearer ones") {
  const Suitability good{.fits = 12, .doubtful = 0, .assd_mm = 0.26};
  CHECK(good.better_than({.fits = 12, .doubtful = 4, .assd_mm = 0.11}));
  CHECK(good.better_than({.fits = 11, .doubtful = 0, .assd_mm = 0.27}));
  CHECK_FALSE(good.better_than({.fits = 12, .doubtful = 0, .assd_mm = 0.11}));
  CHECK(Suitability{.fits = 12, .doubtful = 1}.better_than({.fits = 6, .doubtful = 1}));
}

TEST_CASE("a template is fitted to others only and to so many at most") {
  std::vector<Boundary> eggs;
  for (int number = 0; number < 5; ++number) eggs.push_back(mesh_boundary(egg(number)));
  const Mesh own = test::must(own_template(eggs[2], 300)).mesh;
  const auto the_template = test::must(make_template({own.points, own.topology->triangles()}, "own"));
  const Suitability all = test::must(suitability(*the_template, 2, eggs, 12));
  CHECK(all.fits == 4);
  CHECK(all.doubtful == 0);
  CHECK(all.assd_mm > 0);
  CHECK(all.assd_mm < 0.5);
  CHECK(test::must(suitability(*the_template, 2, eggs, 2)).fits == 2);
}
