#include "core/base/processes/progress.h"

#include <doctest/doctest.h>

using namespace homolog;

TEST_CASE("parts of a work that is itself a part add up to that part") {
  Progress whole;
  whole.part(0, 0.25);
  {
    Progress first(whole, 0.5), second(whole, 0.5);
    first.report(1);
    CHECK(whole.fraction() == doctest::Approx(0.125));
    second.report(0.5);
    second.report(1);
  }
  CHECK(whole.fraction() == doctest::Approx(0.25));
  whole.part(0.25, 1);
  Progress rest(whole, 1);
  Progress half(rest, 0.5);
  half.report(1);
  CHECK(rest.fraction() == doctest::Approx(0.5));
  CHECK(whole.fraction() == doctest::Approx(0.625));
}

TEST_CASE("who cancels the whole cancels its parts, not the other way round") {
  Progress whole, other;
  Progress part(whole, 0.5), of_other(other, 0.5);
  whole.cancel();
  CHECK(part.cancelled());
  of_other.cancel();
  CHECK_FALSE(other.cancelled());
}
