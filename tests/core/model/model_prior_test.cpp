#include "core/model/model_prior.h"

#include <doctest/doctest.h>

#include "core/adapt/fit.h"
#include "core/adapt/snap.h"
#include "core/base/processes/parallel.h"
#include "core/measure/compare.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_quality.h"
#include "tests/must.h"
#include "tests/refusal.h"
#include "tests/thread_limit.h"

// Fits among the shapes that a model allows.

namespace homolog {

namespace {

/// An egg that grows longer with `t` and winds about its long axis as it does: who knows the one knows the other. The
/// surface alone hardly shows how far it is wound.
Mesh egg(double t) {
  Mesh mesh = icosphere(3, 1);
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i) {
    const Vec3 p = mesh.points.row(i);
    const double turn = 0.6 * t * p.z();
    const Vec3 turned(std::cos(turn) * p.x() - std::sin(turn) * p.y(), std::sin(turn) * p.x() + std::cos(turn) * p.y(),
                      p.z());
    const double girth = 1 - 0.25 * p.z();
    mesh.points.row(i) = Vec3(22 * girth * turned.x(), 24 * girth * turned.y(), 34 * (1 + 0.2 * t) * p.z());
  }
  return mesh;
}

std::shared_ptr<const Template> egg_template() {
  const Mesh mesh = egg(0);
  MeshFile file{mesh.points, mesh.topology->triangles()};
  return test::must(make_template(std::move(file), "egg.ply"));
}

ShapeModel egg_model() {
  const std::vector<double> ages{-1, -0.7, -0.3, 0, 0.4, 0.6, 1};
  ShapeMatrix shapes(3 * egg(0).points.rows(), std::ssize(ages));
  for (std::size_t k = 0; k < ages.size(); ++k) {
    const Points points = egg(ages[k]).points;
    shapes.col(static_cast<Eigen::Index>(k)) = Eigen::Map<const Eigen::VectorXd>(points.data(), points.size());
  }
  return make_model(principal_components(std::move(shapes)), 0.99, egg(0).topology, {});
}

FitOptions with_model(double beyond) {
  AllowedShapes allowed = test::must(allowed_by(egg_model(), *egg_template()));
  allowed.beyond = beyond;
  FitOptions options;
  options.allowed = std::make_shared<const AllowedShapes>(std::move(allowed));
  return options;
}

Mesh moved_egg(double t) {
  Mesh mesh = egg(t);
  mesh.points.rowwise() += Eigen::RowVector3d(7, -4, 11);
  return mesh;
}

double vertex_error_mm(const Mesh& mesh, const Mesh& truth) {
  return (mesh.points - truth.points).rowwise().norm().mean();
}

}  // namespace

TEST_CASE("a fit with a model finds the shape and where its vertices belong") {
  const auto the_template = egg_template();
  const Mesh truth = moved_egg(0.8);
  const Boundary boundary = mesh_boundary(truth);
  const FitResult with = test::must(fit_to_boundary(*the_template, boundary, with_model(0)));
  const FitResult without = test::must(fit_to_boundary(*the_template, boundary));
  CHECK(mean_surface_distance_mm(with.mesh, truth) < 0.35);
  CHECK(vertex_error_mm(with.mesh, truth) < 1.5);
  CHECK(vertex_error_mm(with.mesh, truth) < vertex_error_mm(without.mesh, truth) / 3);
  CHECK(with.mesh.points == with.allowed);
  CHECK(without.allowed.size() == 0);
}

TEST_CASE("a fit goes as far beyond the model as asked") {
  const auto the_template = egg_template();
  Mesh bumped = moved_egg(-0.5);
  const Vec3 top = bumped.points.row(0);
  for (Eigen::Index i = 0; i < bumped.points.rows(); ++i) {
    const Vec3 away = bumped.points.row(i).transpose() - top;
    bumped.points.row(i) +=
        8 * std::exp(-away.squaredNorm() / (2 * 8 * 8)) * (top - Vec3(7, -4, 11)).normalized().transpose();
  }
  const Boundary boundary = mesh_boundary(bumped);
  std::array<double, 3> distance_mm{};
  for (std::size_t k = 0; k < 3; ++k) {
    const FitResult fit =
        test::must(fit_to_boundary(*the_template, boundary, with_model(0.5 * static_cast<double>(k))));
    distance_mm[k] = mean_surface_distance_mm(fit.mesh, bumped);
    CHECK(fit.turned_triangles == 0);
    CHECK(fit.self_intersections == 0);
    CHECK((fit.placement.apply(the_template->points) - fit.mesh.points).rowwise().norm().mean() < 6);
  }
  CHECK(distance_mm[0] > 0.3);
  CHECK(distance_mm[1] < 0.7 * distance_mm[0]);
  CHECK(distance_mm[2] < 0.15);
}

TEST_CASE("a fit with a model gives the same bits with one thread and with many") {
  const auto the_template = egg_template();
  const Boundary boundary = mesh_boundary(moved_egg(0.5));
  Points one, many;
  {
    const ThreadLimit limit(1);
    one = test::must(fit_to_boundary(*the_template, boundary, with_model(1))).mesh.points;
  }
  {
    const ThreadLimit limit(3);
    many = test::must(fit_to_boundary(*the_template, boundary, with_model(1))).mesh.points;
  }
  CHECK(one == many);
}

TEST_CASE("a model keeps a snap to the shapes that it allows") {
  const Mesh truth = egg(0.6);
  Volume image;
  image.geometry.dims = {40, 40, 48};
  image.geometry.spacing_mm.setConstant(2);
  image.geometry.origin_mm = Vec3(-39, -39, -47);
  std::vector<float> voxels;
  const auto outside_mm = [](const Vec3& p) {
    const double z = p.z() / (34 * 1.12), girth = 1 - 0.25 * z;
    return 25 * (Vec3(p.x() / (22 * girth), p.y() / (24 * girth), z).norm() - 1);
  };
  for (int k = 0; k < 48; ++k)
    for (int j = 0; j < 40; ++j)
      for (int i = 0; i < 40; ++i)
        voxels.push_back(static_cast<float>(
            100 / (1 + std::exp(outside_mm(image.geometry.to_mm(Vec3(i, j, k))) / 0.7)) + (i + j + k) % 3));
  image.data = std::move(voxels);
  image.range_max = 104;
  const auto the_template = egg_template();
  const AllowedShapes allowed = test::must(allowed_by(egg_model(), *the_template));
  const AllowedFit found = test::must(snap_allowed(image, 0, allowed, the_template->topology, {}, {}));
  CHECK(mean_surface_distance_mm({truth.topology, found.points}, truth) < 1);
  CHECK(vertex_error_mm({truth.topology, found.points}, truth) < 3);
  Similarity far;
  far.translation = Vec3(500, 0, 0);
  CHECK_FALSE(snap_allowed(image, 0, allowed, the_template->topology, far, {}));
}

TEST_CASE("of a joint model the structure that the template is of says what is allowed") {
  // Two eggs one above the other; the upper one is as long as the lower one is short.
  const std::vector<double> ages{-1, -0.5, 0, 0.4, 1};
  const Eigen::Index n = egg(0).points.rows();
  ShapeMatrix shapes(6 * n, std::ssize(ages));
  for (std::size_t k = 0; k < ages.size(); ++k) {
    const Points lower = egg(ages[k]).points;
    Points upper = egg(-ages[k]).points;
    upper.col(2).array() += 120;
    shapes.col(static_cast<Eigen::Index>(k)) << Eigen::Map<const Eigen::VectorXd>(lower.data(), lower.size()),
        Eigen::Map<const Eigen::VectorXd>(upper.data(), upper.size());
  }
  ShapeModel joint = make_model(principal_components(std::move(shapes)), 1, nullptr, {});
  joint.parts = {{"egg", 0, n, 0, 0}, {"other egg", n, n, 0, 0}};
  const auto length = [](const AllowedShapes& allowed, const Mesh& target) {
    const Points normals = vertex_normals(target);
    const Points found = allowed.nearest(target.points, normals, VertexScalars::Ones(normals.rows()), 0.5).posed;
    return found.col(2).maxCoeff() - found.col(2).minCoeff();
  };
  const AllowedShapes allowed = test::must(allowed_by(joint, *egg_template()));
  REQUIRE(allowed.mean.rows() == n);
  CHECK(length(allowed, egg(1)) == doctest::Approx(2 * 34 * 1.2).epsilon(0.02));
  MeshFile file{egg(0).points, egg(0).topology->triangles()};
  const auto nameless = test::must(make_template(file, "third.ply"));
  CHECK(
      says(allowed_by(joint, *nameless), "several structures of the template's numbering, such as egg and other egg"));
  joint.parts[1].vertices -= 1;
  CHECK(allowed_by(joint, *nameless));
  joint.parts[0].vertices -= 1;
  CHECK(says(allowed_by(joint, *nameless), "no structure of the template's numbering"));
}

TEST_CASE("a model of another numbering is refused") {
  const Mesh ball = icosphere(2, 20);
  MeshFile file{ball.points, ball.topology->triangles()};
  CHECK_FALSE(allowed_by(egg_model(), *test::must(make_template(file, "ball.ply"))));
  MeshFile turned{egg(0).points, egg(0).topology->triangles()};
  turned.triangles = (*turned.triangles)(Eigen::all, std::array{0, 2, 1});
  CHECK_FALSE(allowed_by(egg_model(), *test::must(make_template(turned, "inside out.ply"))));
}

}  // namespace homolog
