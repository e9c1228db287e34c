#include <doctest/doctest.h>

#include "core/assist/assist.h"
#include "core/catalogue/catalogue.h"
#include "core/deform/fold_guard.h"
#include "core/deform/tangential.h"
#include "core/measure/compare.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/mesh_quality.h"
#include "core/phantom/phantom.h"
#include "core/session/session.h"
#include "tests/must.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

/// The kidney of subject 2 as a case: its surface is right, but landmarks have flowed along it by some mm. Those that
/// have names are placed in the image.
EditSession flowed_kidney() {
  const auto the_template = test::must(load_template("built-in:kidney"));
  const MeshFile truth = phantom_truth(Organ::kidney, 2).front();
  EditSession session(new_document("", nullptr, the_template));
  test::must(session.apply(SetLandmarkPull{LandmarkPull::similarity}));
  for (const Landmark& landmark : truth.landmarks)
    test::must(session.apply(PlaceLandmark{landmark.name, landmark.position}));
  const SurfaceSearch surface({the_template->topology, truth.points});
  const Box box = bounds_of(truth.points);
  Points flowed = truth.points;
  for (Eigen::Index i = 0; i < flowed.rows(); ++i) {
    const double height = (flowed(i, 2) - box.center().z()) / box.sizes().z();
    flowed.row(i) += Eigen::RowVector3d(0, 3, 4) * (1 - 4 * height * height);
    flowed.row(i) = surface.nearest(Vec3(flowed.row(i))).position.transpose();
  }
  test::must(session.apply(points_edit(*session.document().view(), flowed, PointsFinder("test"))));
  return session;
}

const Points& points_now(const EditSession& session) {
  return *session.document().view()->shape.points;
}

double error_mm(const Points& points) {
  return mean_distance(points, phantom_truth(Organ::kidney, 2).front().points);
}

}  // namespace

TEST_CASE("landmarks that flowed along a surface come back and the surface stays") {
  EditSession session = flowed_kidney();
  const Mesh before = session.document().view()->mesh();
  const double error_before_mm = error_mm(before.points);
  CHECK(error_before_mm > 2.5);
  const VertexScalars known = known_vertices(session.document().view()->shape);
  test::must(session.apply(test::must(refine_shape(*session.document().view())).action));
  CHECK(error_mm(points_now(session)) < 0.75 * error_before_mm);
  CHECK(compare_meshes(session.document().view()->mesh(), before).assd_mm < 0.05);
  CHECK(known_vertices(session.document().view()->shape) == known);
  CHECK(session.undo_name() == "refine");
  test::must(session.apply(Undo{}));
  CHECK(points_now(session) == before.points);
}

TEST_CASE("confirmed landmarks stay while the others are refined") {
  EditSession session = flowed_kidney();
  const Points before = points_now(session);
  test::must(session.apply(Confirm{Vec3(before.row(100)), 25, true}));
  const VertexScalars& confirmed = *session.document().view()->shape.confirmed;
  const RefineEdit refined = test::must(refine_shape(*session.document().view()));
  CHECK(refined.warnings.empty());
  const Points after = *refined.action.points;
  int moved = 0;
  for (Eigen::Index i = 0; i < after.rows(); ++i) {
    if (confirmed[i] == 1) CHECK(after.row(i) == before.row(i));
    moved += (after.row(i) - before.row(i)).norm() > 0.5;
  }
  CHECK(confirmed.sum() > 50);
  CHECK(moved > 500);
  const Document& document = session.document();
  CHECK(surface_distance({document.structure()->the_template->topology, after}, document.view()->mesh()).mean_mm <
        0.05);
  CHECK(turned_triangles(*document.structure()->the_template->topology, *document.view()->shape.placed, after).empty());
}

TEST_CASE("the rim of an open mesh stays where it is") {
  const auto the_template = test::must(load_template("built-in:ventricle"));
  const MeshFile truth = phantom_truth(Organ::ventricle, 1).front();
  EditSession session(new_document("", nullptr, the_template));
  test::must(session.apply(points_edit(*session.document().view(), truth.points, PointsFinder("test"))));
  const Mesh before = session.document().view()->mesh();
  const Points after = *test::must(refine_shape(*session.document().view())).action.points;
  CHECK((after - before.points).rowwise().norm().maxCoeff() > 0.5);
  REQUIRE(!the_template->topology->rims().empty());
  CHECK((on_rims(before, after) - after).cwiseAbs().maxCoeff() < 1e-5);
  CHECK(surface_distance(before, {the_template->topology, after}).mean_mm < 0.05);
}

TEST_CASE("a refined mesh of which not all triangles could be compared is not called sound") {
  // A tube along a diagonal, of triangles so long that the boxes of all overlap.
  Mesh tube = shapes::open_cylinder(2, 1200, 20, 400);
  const Mat3 along = Eigen::Quaterniond::FromTwoVectors(Vec3(0, 0, 1), Vec3(1, 1, 1)).toRotationMatrix();
  tube.points = tube.points * along.transpose();
  REQUIRE(find_self_intersections(tube).pairs.empty());
  REQUIRE_FALSE(find_self_intersections(tube).all);
  Template the_template;
  the_template.source = "tube";
  the_template.topology = tube.topology;
  the_template.points = tube.points;
  the_template.stiffness = VertexScalars::Ones(tube.points.rows());
  const Document document = new_document("", nullptr, std::make_shared<const Template>(std::move(the_template)));
  const RefineEdit refined = test::must(refine_shape(*document.view()));
  REQUIRE(refined.warnings.size() == 1);
  CHECK(refined.warnings.front().starts_with("So many triangles lie close to each other"));
}

TEST_CASE("without a mesh there is nothing to refine and a refinement that is cancelled says so") {
  CHECK(shape_to("refine", new_document("", nullptr, nullptr)).error().sentence() ==
        "There is no mesh to refine; load a template first.");
  Progress progress;
  progress.cancel();
  const EditSession kidney = flowed_kidney();
  CHECK_FALSE(refine_shape(*kidney.document().view(), &progress));
}
