#include "core/base/pictures/caption_sizes.h"

#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>

namespace homolog {

TEST_CASE("scale bars have round lengths that fit") {
  for (const double mm_per_px : {0.013, 0.5, 0.77, 12.0}) {
    const double length = scale_bar_mm(mm_per_px, 100);
    CHECK(length <= 100 * mm_per_px);
    CHECK(length > 100 * mm_per_px / 2.5 - 1e-9);
    const double digit = length / std::pow(10, std::floor(std::log10(length) + 1e-9));
    CHECK((std::abs(digit - 1) < 1e-9 || std::abs(digit - 2) < 1e-9 || std::abs(digit - 5) < 1e-9));
  }
}

}  // namespace homolog
