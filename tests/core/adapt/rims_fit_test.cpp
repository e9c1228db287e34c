#include "core/mesh/parts/rims.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/adapt/fit.h"
#include "core/adapt/judge_fit.h"
#include "core/base/numbers/statistics.h"
#include "core/mesh/construction/clip.h"
#include "core/mesh/construction/icosphere.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/mesh_quality.h"
#include "core/template_making/mesh_template.h"
#include "core/template_making/template_file.h"
#include "tests/adapting.h"
#include "tests/real_data.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

/// Semi-axes of the egg that is cut, mm, and the height of the cut.
constexpr double long_mm = 40, wide_mm = 30, deep_mm = 22, rim_height_mm = 18;

/// An egg with a dent, whose vertices are numbered alike at every growth.
Mesh dented_egg(double growth) {
  Mesh egg = icosphere(4, 1);
  for (Eigen::Index i = 0; i < egg.points.rows(); ++i) {
    const Vec3 p = egg.points.row(i);
    const double dent = 1 - 0.35 * std::exp(-4 * (p - Vec3(1, 0, -0.2)).squaredNorm());
    egg.points.row(i) = dent * growth * Vec3(wide_mm * p.x(), deep_mm * p.y(), long_mm * p.z()).transpose();
  }
  return egg;
}

Mesh open_egg(double growth = 1) {
  return clipped(dented_egg(growth), Vec3::UnitZ(), growth * rim_height_mm).value();
}

MeshFile file_of(const Mesh& mesh) {
  return {mesh.points, mesh.topology->triangles()};
}

}  // namespace

TEST_CASE("the rim of an open surface has its length and a pinhole is none") {
  const Mesh tube = shapes::open_cylinder(10, 100, 10, 30);
  const auto rims = long_rims(tube);
  REQUIRE(rims.size() == 2);
  for (const Rim& rim : rims) {
    CHECK(rim.size() == 100);
    CHECK(rim_length_mm(rim, tube.points) == doctest::Approx(2 * std::numbers::pi * 10).epsilon(0.001));
  }
  const Mesh ball = icosphere(4, 20);
  const Triangles all = ball.topology->triangles();
  const Mesh pierced{Topology::make(ball.points.rows(), all.topRows(all.rows() - 1)).value(), ball.points};
  CHECK(pierced.topology->rims().size() == 1);
  CHECK(long_rims(pierced).empty());
  const Vec3 beside(11, 0, 40);
  const RimPlace place = nearest_on_rims(rims, tube.points, beside);
  CHECK(std::abs(place.position.head<2>().norm() - 10) < 0.01);
}

TEST_CASE("two rings lie as far apart as one is wider") {
  const RimDistance apart =
      rim_distance(shapes::open_cylinder(10, 100, 10, 30), shapes::open_cylinder(10, 100, 10.5, 30));
  CHECK(apart.mean_mm == doctest::Approx(0.5).epsilon(0.02));
  CHECK(apart.p95_mm == doctest::Approx(0.5).epsilon(0.02));
}

TEST_CASE("the vertices of a rim spread into a bay that the nearest places leave out") {
  // A circle, and one of the same radius with a bay 6 mm deep and 3 mm wide.
  constexpr int vertices = 60, finer = 1200;
  const auto circle = [](int count, auto radius_at) {
    Points points(count, 3);
    for (int k = 0; k < count; ++k) {
      const double u = 2 * std::numbers::pi * k / count;
      points.row(k) = radius_at(u) * Eigen::RowVector3d(std::cos(u), std::sin(u), 0);
    }
    return points;
  };
  const auto in_turn = [](int count) {
    Rim rim(static_cast<std::size_t>(count));
    std::iota(rim.begin(), rim.end(), 0);
    return rim;
  };
  const Points plain = circle(vertices, [](double) { return 20.0; });
  const Points bay = circle(finer, [](double u) { return 20 - 6 * std::exp(-std::pow((u - 3) / 0.1, 2)); });
  const Rim rim = in_turn(vertices), onto = in_turn(finer);
  const std::vector<double> rest_mm = rim_edges_mm(rim, plain);
  Points spread = plain;
  for (int round = 0; round < 20; ++round) {
    const auto places = spread_on_rim(rim, spread, rest_mm, onto, bay);
    for (std::size_t k = 0; k < places.size(); ++k) spread.row(static_cast<Eigen::Index>(k)) = places[k].transpose();
  }
  const double deepest_mm = spread.rowwise().norm().minCoeff();
  CHECK(deepest_mm < 15.5);
  const auto edges_mm = rim_edges_mm(rim, spread);
  CHECK(*std::ranges::max_element(edges_mm) < 1.5 * mean_of(edges_mm));
  CHECK((spread.row(0) - plain.row(0)).norm() < 1.5);  // far from the bay it hardly slides
}

TEST_CASE("a template of an open surface ends where that ends and no cap is invented") {
  const Mesh open = open_egg();
  const MeshTemplate made = make_mesh_template(file_of(open), {.vertices = 1500}).value();
  CHECK(made.mesh.points.rows() == 1500);
  CHECK(made.mended.holes == 0);
  REQUIRE(made.mesh.topology->rims().size() == 1);
  const Rim& rim = made.mesh.topology->rims().front();
  const double length_mm = rim_length_mm(rim, made.mesh.points);
  CHECK(length_mm == doctest::Approx(rim_length_mm(open.topology->rims().front(), open.points)).epsilon(0.005));
  CHECK(rim_distance(made.mesh, open).p95_mm < 0.1);
  CHECK(surface_area_mm2(made.mesh) == doctest::Approx(surface_area_mm2(open)).epsilon(0.01));
  // The vertices of the rim are as far from each other as those beside them.
  const double edge_mm = mean_edge_mm(*made.mesh.topology, made.mesh.points);
  CHECK(length_mm / static_cast<double>(rim.size()) == doctest::Approx(edge_mm).epsilon(0.15));
  CHECK(mesh_quality(made.mesh).min_angle_deg > 25);

  // Holes that are to be closed are.
  const MeshTemplate closed = make_mesh_template(file_of(open), {.vertices = 1500, .longest_rim_share = 10}).value();
  CHECK(closed.mesh.topology->closed());
  CHECK(closed.mended.holes == 1);
}

TEST_CASE("an open surface is not rebuilt from voxels which would close it") {
  const auto made = make_mesh_template(file_of(open_egg()), {.vertices = 1500, .closing_mm = 2});
  REQUIRE_FALSE(made);
  CHECK(made.error().what.find("is open, and would have to be rebuilt") != std::string::npos);
  CHECK(made.error().what.find("--holes all") != std::string::npos);
}

TEST_CASE("a template with a rim is fitted rim to rim and its vertices lie as near their places as a closed one's") {
  const Mesh open = open_egg(), target = open_egg(1.25);
  const auto the_template = make_template(file_of(open), "open").value();
  const FitResult fit = fit_to_boundary(*the_template, mesh_boundary(target)).value();
  const FitJudgement judgement = judge_fit(*the_template, mesh_boundary(target), {}, fit);
  REQUIRE(judgement.rim);
  CHECK(judgement.rim->mean_mm < 0.05);
  CHECK(judgement.rim->p95_mm < 0.2);
  CHECK(judgement.agreement.assd_mm < 0.1);
  CHECK_FALSE(judgement.doubtful);
  CHECK(fit.turned_triangles == 0);
  const auto closed_template = make_template(file_of(dented_egg(1)), "closed").value();
  const FitResult closed = fit_to_boundary(*closed_template, mesh_boundary(dented_egg(1.25))).value();
  const double off_mm = mean_distance(fit.mesh.points, target.points),
               closed_off_mm = mean_distance(closed.mesh.points, dented_egg(1.25).points);
  CHECK(off_mm < closed_off_mm + 0.2);
}

TEST_CASE("of a target a hole is closed and its rim stays whatever else is wrong with it") {
  const Mesh open = make_mesh_template(file_of(open_egg()), {.vertices = 1500}).value().mesh;
  const Mesh target{open.topology, 1.25 * open.points};
  const auto the_template = make_template(file_of(open), "open").value();
  const auto boundary_of = [](const MeshFile& file) { return surface_boundary(file, 1500, nullptr, false, 1).value(); };
  const Boundary clean = boundary_of(file_of(target));
  CHECK(clean.surface.points == target.points);
  CHECK(clean.warnings.empty());

  MeshFile flawed = file_of(target);  // one vertex that no face has
  flawed.points.conservativeResize(flawed.points.rows() + 1, Eigen::NoChange);
  flawed.points.bottomRows(1) << 0, 0, 0;
  const Boundary mended = boundary_of(flawed);
  CHECK(mended.surface.points.rows() == target.points.rows());
  CHECK(long_rims(mended.surface).size() == 1);
  CHECK(std::ranges::none_of(mended.warnings,
                             [](const std::string& said) { return said.find("closed flat") != std::string::npos; }));

  // A hole 15 mm wide, longer around than a tenth of the diagonal: the faces at vertices that are near a point.
  Eigen::Index lowest = 0;
  target.points.col(2).minCoeff(&lowest);
  const Vec3 middle = target.points.row(lowest);
  const auto is_near = [&](std::int32_t i) { return (target.points.row(i) - middle.transpose()).norm() < 7.5; };
  std::vector<std::int32_t> number(static_cast<std::size_t>(target.points.rows()), -1), vertices;
  for (std::int32_t i = 0; i < target.points.rows(); ++i)
    if (!is_near(i)) {
      number[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(vertices.size());
      vertices.push_back(i);
    }
  std::vector<std::array<std::int32_t, 3>> faces;
  for (const auto& t : target.topology->triangles().rowwise())
    if (!is_near(t[0]) && !is_near(t[1]) && !is_near(t[2]))
      faces.push_back({number[static_cast<std::size_t>(t[0])], number[static_cast<std::size_t>(t[1])],
                       number[static_cast<std::size_t>(t[2])]});
  MeshFile holed;
  holed.points = target.points(vertices, Eigen::all);
  Triangles& left = holed.triangles.edit();
  left.resize(std::ssize(faces), 3);
  for (std::size_t f = 0; f < faces.size(); ++f)
    left.row(static_cast<Eigen::Index>(f)) << faces[f][0], faces[f][1], faces[f][2];
  REQUIRE(long_rims({Topology::make(holed.points.rows(), holed.triangles).value(), holed.points}).size() == 2);
  const Boundary closed = boundary_of(holed);
  CHECK(long_rims(closed.surface).size() == 1);
  REQUIRE_FALSE(closed.warnings.empty());
  CHECK(closed.warnings.front().find("one hole closed flat") != std::string::npos);
  const FitResult fit = fit_to_boundary(*the_template, closed).value();
  CHECK(judge_fit(*the_template, closed, {}, fit).rim->mean_mm < 0.1);

  // A speck far away makes no hole of the rim, nor does a longer organ of the same width.
  MeshFile specked = file_of(target);
  const Eigen::Index first = specked.points.rows();
  specked.points.conservativeResize(first + 4, Eigen::NoChange);
  specked.points.bottomRows(4) << 500, 0, 0, 501, 0, 0, 500, 1, 0, 500, 0, 1;
  Triangles& own = specked.triangles.edit();
  own.conservativeResize(own.rows() + 4, Eigen::NoChange);
  const auto at = static_cast<std::int32_t>(first);
  own.bottomRows(4) << at, at + 2, at + 1, at, at + 1, at + 3, at, at + 3, at + 2, at + 1, at + 2, at + 3;
  CHECK(long_rims(boundary_of(specked).surface).size() == 1);
  MeshFile longer = file_of(target);
  longer.points.col(2) *= 3;
  CHECK(long_rims(boundary_of(longer).surface).size() == 1);
}

TEST_CASE("a template of a surface fits that surface where a wide opening was closed as a hole") {
  // A cone cut off at both ends, as a ventricle with two valves: the narrower end is longer than half the wider one.
  Mesh cone = shapes::open_cylinder(20, 60, 10, 100);
  const double base_mm = cone.points.col(2).minCoeff();
  for (Eigen::Index i = 0; i < cone.points.rows(); ++i)
    cone.points.row(i).head<2>() *= 1 - 0.4 * (cone.points(i, 2) - base_mm) / 100;
  const Mesh made = make_mesh_template(file_of(cone), {.vertices = 600}).value().mesh;
  REQUIRE(long_rims(made).size() == 1);
  const Boundary boundary = surface_boundary(file_of(cone), 600, nullptr, false, 1).value();
  CHECK(long_rims(boundary.surface).size() == 1);
  REQUIRE_FALSE(boundary.warnings.empty());
  CHECK(boundary.warnings.front().find("one hole closed flat") != std::string::npos);
  const auto the_template = make_template(file_of(made), "cone").value();
  REQUIRE(fit_to_boundary(*the_template, boundary).has_value());
  // Ends that are as wide as one another are no holes of each other.
  const Mesh tube = shapes::open_cylinder(20, 60, 10, 100);
  CHECK(long_rims(surface_boundary(file_of(tube), 600, nullptr, false, 1).value().surface).size() == 2);
}

TEST_CASE("both rims of a heart lie on those of its other phases") {
  const std::filesystem::path folder = real_data();
  if (folder.empty()) return;
  const auto phase = [&](const std::string& number) {
    return read_mesh_file(folder / "meshes/bivme_lv_cine25" / ("patient1_LV_ENDOCARDIAL_" + number + ".obj")).value();
  };
  const MeshTemplate made = make_mesh_template(phase("000"), {.longest_rim_share = 0}).value();
  REQUIRE(long_rims(made.mesh).size() == 2);
  const auto the_template = make_template(file_of(made.mesh), "ventricle").value();
  for (const std::string number : {"005", "009"}) {
    const Boundary boundary = surface_boundary(phase(number), 2500, nullptr, false, 2).value();
    const FitResult fit = fit_to_boundary(*the_template, boundary).value();
    const FitJudgement judgement = judge_fit(*the_template, boundary, {}, fit);
    REQUIRE(judgement.rim);
    CHECK_MESSAGE(judgement.rim->mean_mm < 0.2, number);
    CHECK_MESSAGE(judgement.rim->p95_mm < 1, number);
    CHECK_FALSE(judgement.doubtful);
    CHECK(fit.turned_triangles == 0);
  }
}

TEST_CASE("an open template on an organ that goes on beyond its rim is doubtful and says so") {
  const auto the_template = make_template(file_of(open_egg()), "open").value();
  const Boundary whole = mesh_boundary(dented_egg(1));
  const FitResult fit = fit_to_boundary(*the_template, whole).value();
  const FitJudgement judgement = judge_fit(*the_template, whole, {}, fit);
  CHECK(judgement.beyond_rim_share > 0.02);
  CHECK(judgement.doubtful);
  CHECK(std::ranges::any_of(judgement.warnings, [](const std::string& warning) {
    return warning.find("goes on beyond its rim") != std::string::npos;
  }));
}

TEST_CASE("where parts may be missing the rim of what is left does not draw that of the template") {
  // The egg's upper half is missing, so that the target ends far below where the template does.
  const auto the_template = make_template(file_of(open_egg()), "open").value();
  const Mesh whole = open_egg(1.05), left = clipped(dented_egg(1.05), Vec3::UnitZ(), 0).value();
  const Boundary boundary = mesh_boundary(left);
  FitOptions options;
  options.partial = true;
  const FitResult fit = fit_to_boundary(*the_template, boundary, options).value();
  const FitJudgement judgement = judge_fit(*the_template, boundary, options, fit);
  CHECK_FALSE(fit.outliers.empty());
  CHECK(mean_distance(fit.mesh.points, whole.points) < 2);
  const double ends_mm = long_rims(fit.mesh).front().empty() ? 0 : fit.mesh.points.col(2).maxCoeff();
  CHECK(ends_mm == doctest::Approx(1.05 * rim_height_mm).epsilon(0.15));
  CHECK_FALSE(judgement.doubtful);
  for (const std::string& warning : judgement.warnings) CHECK(warning.find("rims") == std::string::npos);
}
