#include "core/groupwise/other_organs.h"

#include <doctest/doctest.h>

using namespace homolog;

namespace {

std::vector<std::size_t> unlike(const std::vector<double>& doubts, const std::vector<double>& shapes) {
  std::vector<FitSigns> fits;
  for (std::size_t k = 0; k < doubts.size(); ++k) fits.push_back({doubts[k], shapes[k]});
  return unlike_the_others(fits);
}

using Found = std::vector<std::size_t>;

}  // namespace

TEST_CASE("a fit in some doubt whose shape lies far off is of another organ, and a sound one is not") {
  // As kidneys fitted together with a vertebra, and with a kidney whose sinus is open.
  CHECK(unlike({0.023, 0.025, 0.028, 0.142}, {0.08, 0.09, 0.10, 0.22}) == Found{3});
  CHECK(unlike({0.023, 0.025, 0.028, 0.076}, {0.08, 0.09, 0.13, 0.10}).empty());
  CHECK(unlike({0.025, 0.024, 0.027, 0.052}, {0.06, 0.06, 0.07, 0.10}).empty());  // of unusual shape
  // As vertebrae with a kidney, which is in little doubt; and with the vertebra above, which is alike.
  CHECK(unlike({0.017, 0.019, 0.023, 0.050}, {0.08, 0.09, 0.11, 0.155}) == Found{3});
  CHECK(unlike({0.017, 0.019, 0.023, 0.037}, {0.08, 0.09, 0.11, 0.105}).empty());
}

TEST_CASE("four times the doubt of most is enough, and as little as sound organs have is never") {
  CHECK(unlike({0.02, 0.02, 0.081}, {0.1, 0.1, 0.1}) == Found{2});
  CHECK(unlike({0.02, 0.02, 0.079}, {0.1, 0.1, 0.1}).empty());
  CHECK(unlike({0.005, 0.005, 0.039}, {0.1, 0.1, 0.5}).empty());
  CHECK(unlike({0.2, 0.03}, {0.3, 0.1}).empty());  // of two nobody can tell which
}

TEST_CASE("a shape's share is its distance from the mean shape, whatever its size and turn") {
  ShapeMatrix fits(12, 3);
  fits.col(0) << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  fits.col(1) = 5 * fits.col(0);
  fits.col(2) << 0, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0;  // turned: x to y, y to z, z to x
  for (const double share : shape_shares(fits)) CHECK(share == doctest::Approx(0).epsilon(1e-6));
  fits(3, 2) = 0.5;
  const auto shares = shape_shares(fits);
  CHECK(shares[2] > 0.1);
  CHECK(shares[2] > 1.5 * shares[0]);
}

TEST_CASE("a volume that no spread of the others explains is named, either way") {
  CHECK(unlike_in_volume({150, 200, 240, 260, 180, 1204}) == Found{5});
  CHECK(unlike_in_volume({150, 200, 240, 260, 180, 40}) == Found{5});
  CHECK(unlike_in_volume({150, 200, 240, 260, 180, 590}).empty());
  CHECK(unlike_in_volume({20, 60, 200, 700, 2000, 6000}).empty());  // they differ as much by nature
  CHECK(unlike_in_volume({200, 200, 200, 1204}).empty());           // of four nobody can tell
  CHECK(unlike_in_volume({200, 210, 0, 190, 205, 1204, 200}) == Found{5});
}
