#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "core/adapt/boundary/boundary.h"
#include "core/adapt/fit.h"
#include "core/case/actions/points.h"
#include "core/catalogue/catalogue.h"
#include "core/measure/compare.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/model/shape_model.h"
#include "core/phantom/phantom.h"
#include "core/session/case_file.h"
#include "tests/must.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

// What programs that use the library may hand to it by mistake [docs/library.md].

namespace homolog {

TEST_CASE("a boundary of a frame, a grid or a template that cannot be is refused") {
  const Volume labels = make_phantom(Organ::kidney, 1).label_map;
  const auto said = [](const Result<Boundary>& boundary) { return boundary ? "" : boundary.error().what; };
  CHECK(said(label_boundary(labels, 1, 7, std::nullopt, 500)).starts_with("has no frame 7; it has 1"));
  CHECK(said(label_boundary(labels, 1, -1, std::nullopt, 500)).starts_with("has no frame -1"));
  CHECK(said(label_boundary(labels, 1, 0, std::nullopt, 0)).find("four vertices") != std::string::npos);
  Volume larger = labels;
  larger.geometry.dims[0] *= 9;
  CHECK(said(label_boundary(larger, 1, 0, std::nullopt, 500)).find("not what its grid says") != std::string::npos);
  const auto fit = fit_to_boundary(*test::must(load_template("built-in:kidney")), Boundary{}, {});
  REQUIRE_FALSE(fit);
  CHECK(fit.error().what.starts_with("gives no surface"));
}

TEST_CASE("points of another mesh are refused when they are applied") {
  const auto the_template = test::must(load_template("built-in:kidney"));
  EditSession session(new_document("", nullptr, the_template));
  const auto refused = session.apply(points_edit(*session.document().view(), Points::Zero(5, 3), FoundBy::fit));
  REQUIRE_FALSE(refused);
  CHECK(refused.error().what == "5 were given for 2500 vertices");
}

TEST_CASE("a model of nothing has no axes and coefficients beyond its modes do not count") {
  CHECK(principal_components(ShapeMatrix()).scatter.size() == 0);
  CHECK(principal_components(ShapeMatrix(9, 0)).mean.size() == 9);
  const PrincipalComponents components = principal_components(ShapeMatrix::Random(9, 4));
  const ShapeModel model = make_model(components, 1, nullptr, {});
  REQUIRE(model.modes() == 3);
  CHECK(components.basis(50).cols() == 3);
  CHECK(shape_of(model, Eigen::VectorXd::Ones(50)) == shape_of(model, Eigen::VectorXd::Ones(3)));
  CHECK(std::isnan(mean_surface_distance_mm(Mesh{}, icosphere(1, 1))));
}

TEST_CASE("a mesh that was put together wrongly becomes no file") {
  const TemporaryFolder folder;
  for (const char* name : {"a.ply", "a.vtp", "a.obj", "a.stl"}) {
    CAPTURE(std::string(name));
    MeshFile file{icosphere(1, 10).points, icosphere(1, 10).topology->triangles()};
    REQUIRE(write_mesh_file(file, folder.path / name));
    file.doubt_mm = VertexScalars::Ones(3);
    CHECK_FALSE(write_mesh_file(file, folder.path / name));
    file.doubt_mm.reset();
    file.triangles.edit()(0, 0) = 42;
    const auto refused = write_mesh_file(file, folder.path / name);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().what.starts_with("a face names vertex 42 of 42"));
    file.triangles.edit()(0, 0) = -1;
    CHECK_FALSE(write_mesh_file(file, folder.path / name));
    CHECK(read_mesh_file(folder.path / name));  // the one before is still there
  }
}

}  // namespace homolog
