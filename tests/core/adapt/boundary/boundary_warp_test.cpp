#include "core/adapt/boundary/boundary_warp.h"

#include <doctest/doctest.h>

#include "core/adapt/boundary/find_placement.h"
#include "core/catalogue/catalogue.h"
#include "core/phantom/phantom.h"
#include "tests/adapting.h"
#include "tests/shapes.h"

using namespace homolog;

TEST_CASE("a warp along the boundary lays a kidney that differs smoothly near its true places") {
  const auto the_template = built_in(Organ::kidney);
  for (const int subject : {1, 5, 7}) {
    CAPTURE(subject);
    const Mesh truth{the_template->topology, phantom_truth(Organ::kidney, subject).front().points};
    const Boundary boundary = boundary_of(truth);
    BoundarySearch search(boundary, truth.points.rows());
    const Points placed = find_placement(*the_template, boundary).placement.apply(the_template->points);
    const Points warped = warp_along_boundary({the_template->topology, placed}, placed, search);
    CHECK(mean_distance(search.nearest({the_template->topology, warped}).targets, warped) < 0.8);
    CHECK(mean_distance(warped, truth.points) < 0.75 * mean_distance(placed, truth.points));
  }
}
