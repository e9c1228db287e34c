#include <doctest/doctest.h>

#include <cmath>

#include "core/adapt/boundary/surface_target.h"
#include "core/adapt/ways/fit_steps.h"
#include "core/mesh/mesh_quality.h"
#include "tests/must.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

/// The template of a shaft with a ridge, with its tip as a landmark, and a bent shaft as the boundary.
struct Shafts {
  Mesh own = shapes::shaft_with_ridge(0, 4), there = shapes::shaft_with_ridge(0.5, 4);
  std::shared_ptr<const Template> upright = with_landmarks(
      *test::must(make_template({own.points, own.topology->triangles()}, "shaft")), {{"tip", Vec3(0, 0, 60)}});
  Boundary boundary = mesh_boundary(there);
  SurfaceTarget target{boundary, own.points.rows()};
  FitOptions options;

  FitSteps steps() {
    return {*upright, target, options, [](const Points&, double) { return Result<void>{}; }};
  }
  /// A mesh on the boundary whose vertices slid off the ridge.
  Adapting slid() const {
    Adapting shape{{own.topology, shapes::slid_along(there, Vec3(0, 0, 2.5))}, own.points, {}, {}, {}, {}};
    shape.factors = VertexScalars::Ones(own.points.rows());
    shape.place_anew();
    return shape;
  }
};

}  // namespace

TEST_CASE("vertices slide back onto a ridge, as far as asked, and stay on the boundary") {
  Shafts shafts;
  FitSteps steps = shafts.steps();
  const auto off_mm = [&](double share) {
    Adapting shape = shafts.slid();
    REQUIRE(steps.slide_to_facing(shape, shafts.there, share));
    CHECK(std::sqrt(shafts.target.off_mm2(shape.mesh)) < 0.1 * mean_edge_mm(*shape.mesh.topology, shape.mesh.points));
    return shapes::apart_at_ridge_mm(shafts.own, shape.mesh.points, shafts.there.points);
  };
  const double stayed_mm = off_mm(0), half_mm = off_mm(0.5), full_mm = off_mm(1);
  CAPTURE(stayed_mm);
  CAPTURE(half_mm);
  CHECK(full_mm < 0.8 * stayed_mm);
  CHECK(half_mm < 0.95 * stayed_mm);
  CHECK(half_mm > full_mm);
}

TEST_CASE("a slide that would end off the boundary is undone") {
  Shafts shafts;
  shafts.options.landmarks["tip"] = Vec3(0, 3000, 0);  // it would tear the mesh
  FitSteps steps = shafts.steps();
  steps.trust(VertexScalars::Ones(1));
  Adapting shape = shafts.slid();
  const Adapting before = shape;
  REQUIRE(steps.slide_to_facing(shape, shafts.there, 1));
  CHECK(shape.mesh.points == before.mesh.points);
  CHECK(shape.rest == before.rest);
}

TEST_CASE("a vertex that is far off says nothing of where the mesh lies") {
  Shafts shafts;
  FitSteps steps = shafts.steps();
  Mesh mesh = shafts.there;
  const double most_mm = steps.most_off_mm(shafts.target.off_mm2(mesh));
  mesh.points.row(0) += Eigen::RowVector3d(0, 500, 0);
  CHECK(std::sqrt(shafts.target.off_mm2(mesh)) < most_mm);
  mesh.points.rowwise() += Eigen::RowVector3d(0, 1, 0);
  CHECK(std::sqrt(shafts.target.off_mm2(mesh)) > most_mm);
}

TEST_CASE("what is shown can end each step of an adaptation") {
  Shafts shafts;
  FitSteps steps(*shafts.upright, shafts.target, shafts.options,
                 [](const Points&, double) -> Result<void> { return fail("", "enough"); });
  Adapting shape = shafts.slid();
  CHECK_FALSE(steps.settle_as_it_is(shape));
  CHECK_FALSE(steps.slide_to_facing(shape, shafts.there, 1));
  CHECK_FALSE(steps.adapt(shafts.own.points, {}, shafts.own.points, {.steps = 3, .softest_edges = 1}));
}
