#include "core/adapt/boundary/cut_template.h"

#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "core/adapt/fit.h"
#include "core/adapt/judge_fit.h"
#include "core/mesh/construction/clip.h"
#include "core/template_making/mesh_template.h"
#include "core/template_making/template_file.h"
#include "tests/must.h"
#include "tests/shapes.h"

using namespace homolog;

namespace {

constexpr double cut_mm = 25;  ///< of the organ, which reaches to 56: above, nothing is left

/// An organ with two bumps and no plane of symmetry, longest along z.
Mesh organ() {
  Mesh mesh = icosphere(4, 40);
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i) {
    const Vec3 u = Vec3(mesh.points.row(i)).normalized();
    const double bumps = 8 * std::exp(-8 * (u - Vec3(0.6, 0.8, 0)).squaredNorm()) +
                         9 * std::exp(-8 * (u - Vec3(-0.6, 0, -0.8)).squaredNorm());
    Vec3 p = (40 + bumps) * u;
    p.z() *= 1.4;
    p.x() += 0.004 * p.z() * p.z();
    mesh.points.row(i) = p.transpose();
  }
  return mesh;
}

/// What its scan showed of it; `marked`: it says where the scan ended.
std::shared_ptr<const Template> cut_template(bool marked) {
  const Mesh part = clipped(organ(), Vec3::UnitZ(), cut_mm).value();
  const Mesh mesh = test::must(make_mesh_template({part.points, part.topology->triangles()},
                                                  {.vertices = 800, .longest_rim_share = 10}))
                        .mesh;
  MeshFile file = template_file(mesh, {});
  std::vector<std::int32_t> cut;
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i)
    if (mesh.points(i, 2) > cut_mm - 0.5) cut.push_back(static_cast<std::int32_t>(i));
  if (marked) mark_cut(file, cut);
  return test::must(make_template(std::move(file), "cut"));
}

/// The same organ elsewhere, larger and a little turned.
Similarity moved() {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(0.2, Vec3(1, 2, 3).normalized())), 1.1, Vec3(12, -30, 7)};
}

/// How far vertices below the cut lie from where they belong, on average.
double off_mm(const Template& the_template, const FitResult& fit) {
  const Points there = moved().apply(the_template.points);
  double sum = 0;
  int count = 0;
  for (Eigen::Index i = 0; i < there.rows(); ++i)
    if (the_template.points(i, 2) < cut_mm - 5) sum += (there.row(i) - fit.mesh.points.row(i)).norm(), ++count;
  return sum / count;
}

bool says_cut(const FitJudgement& judgement) {
  return std::ranges::any_of(judgement.warnings, [](const std::string& warning) {
    return warning.find("the template is cut off by its scan") != std::string::npos;
  });
}

}  // namespace

TEST_CASE("a template that its scan cut off fits a whole organ as far as it goes and says so") {
  const Mesh whole{organ().topology, moved().apply(organ().points)};
  const Boundary boundary = mesh_boundary(whole);
  const auto marked = cut_template(true), unmarked = cut_template(false);
  const FitResult fit = test::must(fit_to_boundary(*marked, boundary)),
                  without = test::must(fit_to_boundary(*unmarked, boundary));
  const double off = off_mm(*marked, fit), off_without = off_mm(*unmarked, without);
  MESSAGE("vertices lie " << off << " mm off, and " << off_without << " where nobody knows of the cut");
  CHECK(off < 1.5);
  CHECK(off < 0.5 * off_without);
  REQUIRE(fit.template_cuts.size() == 1);
  CHECK(fit.template_cuts.front().outward.dot(moved().rotation * Vec3::UnitZ()) > 0.99);
  CHECK(without.template_cuts.empty());
  const FitJudgement judgement = judge_fit(*marked, boundary, {}, fit);
  CHECK(judgement.inside_scan.assd_mm < 0.5);
  CHECK(judgement.inside_scan.dice > 0.98);
  CHECK(judgement.agreement.assd_mm > 1);  // which counts what is beyond
  CHECK_FALSE(judgement.doubtful);
  CHECK(says_cut(judgement));
  CHECK_FALSE(says_cut(judge_fit(*unmarked, boundary, {}, without)));
}

TEST_CASE("a cut template's planes are those of its flat faces and a whole one has none") {
  const auto marked = cut_template(true);
  const auto borders = cut_borders(*marked, marked->points);
  REQUIRE(borders.size() == 1);
  CHECK(borders.front().outward.z() > 0.99);
  CHECK(borders.front().offset_mm == doctest::Approx(cut_mm).epsilon(0.02));
  CHECK(cut_borders(*cut_template(false), marked->points).empty());
  // No vertex of the flat face is a place that the boundary shows.
  const Boundary shown = cut_as_template(mesh_boundary(organ()), borders);
  for (const std::int32_t i : vertices_in(marked->regions, cut_region)) CHECK_FALSE(shown.shows(marked->points.row(i)));
  CHECK(shown.shows(Vec3(0, 0, 0)));
}
