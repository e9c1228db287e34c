#include "core/adapt/boundary/boundary_warp.h"

#include <doctest/doctest.h>

#include "core/adapt/boundary/find_placement.h"
#include "core/adapt/boundary/surface_target.h"
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
    SurfaceTarget search(boundary, truth.points.rows());
    const Points placed = find_placement(*the_template, boundary).placement.apply(the_template->points);
    const Mesh there{the_template->topology, search.nearest({the_template->topology, placed}).targets};
    const Points warped = warp_along_boundary(there, placed, {Points(0, 3), Points(0, 3), {}}, search);
    CHECK(mean_distance(search.nearest({the_template->topology, warped}).targets, warped) < 0.8);
    CHECK(mean_distance(warped, truth.points) < 0.75 * mean_distance(placed, truth.points));
  }
}

TEST_CASE("the voxels of a label hardly turn a warp aside") {
  const auto the_template = built_in(Organ::kidney);
  for (const int subject : {1, 9}) {
    CAPTURE(subject);
    const PhantomSubject phantom = make_phantom(Organ::kidney, subject);
    const Boundary boundary = label_boundary(phantom.label_map, 1, 0, {}, the_template->points.rows()).value();
    SurfaceTarget search(boundary, the_template->points.rows());
    PlacementHints hints;
    for (const Landmark& landmark : phantom.landmarks) hints.landmarks[landmark.name] = landmark.position;
    const Placed found = find_placement(*the_template, boundary, hints);
    const auto [own, there] = matched_landmarks(*the_template, hints.landmarks);
    const Points placed = found.placement.apply(the_template->points);
    const KnownMatches landmarks = known_matches(placed, found.placement.apply(own), there, found.trust);
    const Points warped = warp_along_boundary({the_template->topology, placed}, placed, landmarks, search),
                 truth = phantom_truth(Organ::kidney, subject).front().points;
    CHECK(mean_distance(warped, truth) < 1.5);
  }
}
