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
  CHECK(side_in("L 4") == Side::none);
  CHECK(side_in("Wirbel L-5") == Side::none);
  CHECK(side_in("Wirbelkörper L vertebrae_L3") == Side::none);
  CHECK(side_in("facet_L3_left") == Side::left);
  CHECK(side_in("rib_L_4") == Side::left);  // a rib, whose number is no level of a letter
  CHECK(name_of_other_side("L 4").empty());
  CHECK(name_of_other_side("rib_L_4") == "rib_R_4");
  CHECK(side_in("bright") == Side::none);
  CHECK(name_of_other_side("kidney_left") == "kidney_right");
  CHECK(name_of_other_side("Right Lung") == "Left Lung");
  CHECK(name_of_other_side("LEFT HIP") == "RIGHT HIP");
  CHECK(name_of_other_side("hip.R") == "hip.L");
  CHECK(name_of_other_side("liver").empty());
}

}  // namespace homolog
