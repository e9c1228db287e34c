#include <doctest/doctest.h>

#include <map>
#include <string>

#include "core/base/numbers/statistics.h"

using namespace homolog;

TEST_CASE("the mean and the middle value and a quantile of a few values") {
  const std::vector<double> values{4, 1, 3, 8};
  CHECK(mean_of(values) == 4);
  CHECK(mean_of(std::vector<double>{}) == 0);
  CHECK(mean_of(std::map<std::string, double>{{"a", 1}, {"b", 2}}, [](const auto& one) { return one.second; }) == 1.5);
  CHECK(median_of(values) == 4);
  CHECK(median_of({5}) == 5);
  CHECK(quantile(values, 0) == 1);
  CHECK(quantile(values, 1) == 8);
  CHECK(quantile(std::vector<double>{}, 0.5) == 0);
}
