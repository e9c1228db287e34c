#include "core/template/other_side.h"

#include <doctest/doctest.h>

#include "core/mesh/construction/icosphere.h"

namespace homolog {

TEST_CASE("the neighbours of the other side are called left for right and right for left") {
  const auto exchanged = [](const char* names) { return names_of_other_side({names, false}).labels; };
  CHECK(exchanged("left atrium") == "right atrium");
  CHECK(exchanged("Left Atrium, aorta,femur_r") == "Right Atrium, aorta,femur_l");
  CHECK(exchanged("cartilage, left,4") == "cartilage, right,4");
  CHECK(exchanged("background,7") == "background,7");
  CHECK(exchanged(",").size() == 1);
  CHECK(exchanged("").empty());
  CHECK(names_of_other_side({"hip.R", true}) == FacedNames{"hip.L", true});
  CHECK(names_of_other_side(names_of_other_side({"LEFT LUNG,heart", false})) == FacedNames{"LEFT LUNG,heart", false});
}

TEST_CASE("a mirrored template faces the neighbours of the other side and keeps its other comments") {
  const Mesh ball = icosphere(1, 10);
  MeshFile file;
  file.points = ball.points;
  file.triangles = ball.topology->triangles();
  file.comments = {"drawn on the left", faced_comment({"left atrium,aorta", false}), missing_share_comment(0.1)};
  for (const auto plane : {AnatomicalPlane::sagittal, AnatomicalPlane::axial}) {
    const MeshFile other = mirrored_with_names(file, plane);
    CHECK(other.points == mirrored(file, plane).points);
    CHECK(other.comments == std::vector<std::string>{"drawn on the left", faced_comment({"right atrium,aorta", false}),
                                                     missing_share_comment(0.1)});
    CHECK(mirrored_with_names(other, plane).comments == file.comments);
  }
}

}  // namespace homolog
