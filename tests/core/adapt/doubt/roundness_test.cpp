#include <doctest/doctest.h>

#include "core/adapt/doubt/roundness.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

/// A ball stretched along z.
double roundness_of_spindle(double times, double radius_mm) {
  Mesh spindle = icosphere(4, radius_mm);
  spindle.points.col(2) *= times;
  return roundness(spindle);
}

}  // namespace

TEST_CASE("a ball is round, a long spindle is not, and between them it goes by degrees") {
  CHECK(roundness_of_spindle(1, 20) == 1);
  CHECK(roundness_of_spindle(10, 20) == 0);
  double last = 1;
  int between = 0;
  for (double times = 1; times < 10; times += 0.25) {
    const double now = roundness_of_spindle(times, 20);
    CHECK(now <= last);
    if (now > 0 && now < 1) ++between;
    last = now;
  }
  CHECK(between > 2);
}

TEST_CASE("roundness does not depend on the size") {
  const double small = roundness_of_spindle(7, 1);
  CHECK(small > 0);
  CHECK(small < 1);
  CHECK(roundness_of_spindle(7, 500) == doctest::Approx(small).epsilon(1e-9));
}
