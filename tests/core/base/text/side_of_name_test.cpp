#include "core/base/text/side_of_name.h"

#include <doctest/doctest.h>

namespace homolog {

TEST_CASE("a name says its side and what its partner is called") {
  CHECK(side_in("kidney_left") == Side::left);
  CHECK(side_in("Right Lung") == Side::right);
  CHECK(side_in("hip.R") == Side::right);
  CHECK(side_in("L Femur") == Side::left);
  CHECK(side_in("liver") == Side::none);
  CHECK(side_in("vertebrae_L3") == Side::none);  // a lumbar vertebra
  CHECK(side_in("bright") == Side::none);
  CHECK(name_of_other_side("kidney_left") == "kidney_right");
  CHECK(name_of_other_side("Right Lung") == "Left Lung");
  CHECK(name_of_other_side("LEFT HIP") == "RIGHT HIP");
  CHECK(name_of_other_side("hip.R") == "hip.L");
  CHECK(name_of_other_side("liver").empty());
}

}  // namespace homolog
