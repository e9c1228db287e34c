#include "core/base/numbers/random.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace homolog;

TEST_CASE("a seed gives the same numbers on every machine") {
  CHECK(mix_bits(0) == 0xe220a8397b1dcdafU);  // the first of splitmix64 [Steele 2014]
  Random first(7), second(7), other(8);
  for (int k = 0; k < 10; ++k) {
    const double number = first.uniform();
    CHECK(number == second.uniform());
    CHECK(number != other.uniform());
  }
}

TEST_CASE("uniform numbers fill their range and normal ones have mean 0 and deviation 1") {
  Random random(3);
  constexpr int count = 20000;
  double low = 1, high = -1, sum = 0, squares = 0;
  for (int k = 0; k < count; ++k) {
    const double number = random.uniform(-1, 1), normal = random.normal();
    low = std::min(low, number);
    high = std::max(high, number);
    sum += normal;
    squares += normal * normal;
    CHECK(std::abs(normal) <= 3.5);
  }
  CHECK(low >= -1);
  CHECK(low < -0.99);
  CHECK(high < 1);
  CHECK(high > 0.99);
  CHECK(std::abs(sum / count) < 0.03);
  CHECK(std::abs(squares / count - 1) < 0.03);
}
