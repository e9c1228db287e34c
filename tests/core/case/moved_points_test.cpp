#include "core/case/moved_points.h"

#include <doctest/doctest.h>

#include <random>

namespace homolog {

TEST_CASE("moves come to the same place from half a step away") {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> mm(-200, 200);
  Points from(1000, 3);
  for (Eigen::Index k = 0; k < from.size(); ++k) {
    from.data()[k] = mm(random);
    if (k % 3 == 0) from.data()[k] = (std::floor(from.data()[k] * 65536) + 0.5) / 65536;  // where rounding is undecided
  }
  Points to = from;
  for (Eigen::Index k = 0; k < to.size(); ++k) to.data()[k] = on_grid(from.data()[k] + (k % 2 == 0 ? 0 : mm(random)));
  const auto moves = moves_of(from, {FoundBy::snap, std::nullopt, std::make_shared<const Points>(to)});
  REQUIRE(moves);
  for (const double off : {0.0, 1e-12, -1e-12, 0.4 / 65536, -0.4 / 65536}) {
    const Points near = from.array() + off;
    CHECK(*points_of(near, *moves)->points == to);
  }
  to(5, 1) += 1e-9;
  CHECK_FALSE(moves_of(from, {FoundBy::snap, std::nullopt, std::make_shared<const Points>(to)}));
  CHECK_FALSE(points_of(from.topRows(999), *moves));
}

}  // namespace homolog
