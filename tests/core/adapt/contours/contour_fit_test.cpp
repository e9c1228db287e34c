#include "core/adapt/contours/contour_fit.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/adapt/contours/contour_target.h"
#include "core/base/files/files.h"
#include "core/measure/compare.h"
#include "core/measure/plane_section.h"
#include "core/mesh/files/curve_io.h"
#include "tests/ball.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

using namespace homolog;

namespace {

/// A ball that is stretched along its axes.
Mesh egg(const Vec3& half_axes, const Vec3& centre) {
  Mesh mesh = icosphere(4, 1);
  mesh.points = (mesh.points * half_axes.asDiagonal()).rowwise() + centre.transpose();
  return mesh;
}

/// Where planes at these heights along `normal` cut a surface.
std::vector<DrawnContour> cuts(const Mesh& mesh, const Vec3& normal, const std::vector<double>& heights,
                               double times = 1) {
  std::vector<DrawnContour> contours;
  for (const double height : heights)
    for (const SectionLine& line : plane_section(mesh, height * normal, normal)) {
      Contour curve{.points = line.points};
      Vec3 centre = Vec3::Zero();
      for (const Vec3& p : curve.points) centre += p / static_cast<double>(curve.points.size());
      for (Vec3& p : curve.points) p = centre + times * (p - centre);
      contours.push_back({.curve = curve, .outside = times > 1});
    }
  return contours;
}

void write_text(const std::filesystem::path& file, const std::string& text) {
  REQUIRE(write_whole_file(file, text));
}

}  // namespace

TEST_CASE("a template goes through contours and follows its own shape between them") {
  const Mesh organ = egg({24, 16, 30}, {10, -20, 40});
  const auto ball = ball_template(20);
  const auto contours = cuts(organ, Vec3::UnitZ(), {16, 28, 40, 52, 64});
  REQUIRE(contours.size() == 5);
  const auto fit = fit_to_contours(*ball, contours);
  REQUIRE(fit);
  const ContourDistance off = contour_distance(contours, fit->mesh);
  CHECK(off.mean_mm < 0.1);
  CHECK(off.p95_mm < 0.3);
  // The poles lie 6 mm beyond the last contours.
  CHECK(compare_meshes(fit->mesh, organ).assd_mm < 0.5);
  CHECK(fit->turned_triangles == 0);
  CHECK(fit->self_intersections == 0);
}

TEST_CASE("contours need not be parallel and open ones count") {
  const Mesh organ = egg({24, 16, 30}, {10, -20, 40});
  auto contours = cuts(organ, Vec3::UnitZ(), {40});
  for (const DrawnContour& one : cuts(organ, Vec3::UnitX(), {10})) contours.push_back(one);
  for (DrawnContour one : cuts(organ, Vec3(0, 1, 1).normalized(), {16})) {
    one.curve.closed = false;
    one.curve.points.resize(one.curve.points.size() / 2);
    contours.push_back(one);
  }
  const auto fit = fit_to_contours(*ball_template(20), contours);
  REQUIRE(fit);
  CHECK(contour_distance(contours, fit->mesh).mean_mm < 0.2);
  CHECK(compare_meshes(fit->mesh, organ).assd_mm < 0.8);
}

TEST_CASE("within loose strokes the mesh lies nearer to the organ than the strokes do") {
  const Mesh organ = egg({20, 16, 18}, {0, 0, 0});
  const auto strokes = cuts(organ, Vec3::UnitZ(), {-12, -6, 0, 6, 12}, 1.25);
  const auto fit = fit_to_contours(*ball_template(20), strokes);
  REQUIRE(fit);
  // It reaches beyond no stroke, and is off by less than half of their distance of 4 mm.
  CHECK(contour_distance(strokes, fit->mesh).mean_mm < 0.05);
  CHECK(compare_meshes(fit->mesh, organ).assd_mm < 2);
}

TEST_CASE("the rim of a hole pulls at no template without tunnels") {
  const Mesh organ = egg({20, 16, 24}, {0, 0, 0});
  auto contours = cuts(organ, Vec3::UnitZ(), {-16, -8, 0, 8, 16});
  const auto without = fit_to_contours(*ball_template(20), contours);
  for (const DrawnContour& hole : cuts(egg({4, 3, 5}, {2, 1, 0}), Vec3::UnitZ(), {0})) contours.push_back(hole);
  const auto with = fit_to_contours(*ball_template(20), contours);
  REQUIRE(without);
  REQUIRE(with);
  REQUIRE(with->warnings.size() == 1);
  CHECK(with->warnings[0].find("rims of holes") != std::string::npos);
  CHECK(compare_meshes(with->mesh, without->mesh).assd_mm < 0.3);
}

TEST_CASE("contours that are all combined by exclusive or are as others and only those within others are holes") {
  const Mesh organ = egg({20, 16, 24}, {0, 0, 0});
  auto contours = cuts(organ, Vec3::UnitZ(), {-16, -8, 0, 8, 16});
  for (const DrawnContour& hole : cuts(egg({6, 5, 5}, {2, 1, 0}), Vec3::UnitZ(), {0})) contours.push_back(hole);
  for (const DrawnContour& island : cuts(egg({2, 2, 2}, {2, 1, 0}), Vec3::UnitZ(), {0})) contours.push_back(island);
  const ContourSamples plain = sampled_contours(contours, 400);
  for (DrawnContour& one : contours) one.curve.cuts_out = true;
  const ContourSamples combined = sampled_contours(contours, 400);
  REQUIRE(combined.samples.size() == plain.samples.size());
  for (std::size_t k = 0; k < plain.samples.size(); ++k) {
    const ContourSample& one = combined.samples[k];
    CHECK(one.hole == plain.samples[k].hole);
    CHECK(one.outward == plain.samples[k].outward);
    const double from_hole = (one.at - Vec3(2, 1, 0)).cwiseQuotient(Vec3(6, 5, 1)).head<2>().norm();
    CHECK(one.hole == (std::abs(one.at.z()) < 1e-6 && from_hole > 0.5 && from_hole < 1.5));
  }
}

TEST_CASE("the rims of holes do not count in the distance of a mesh without tunnels") {
  const Mesh organ = egg({20, 16, 24}, {0, 0, 0});
  auto contours = cuts(organ, Vec3::UnitZ(), {-16, -8, 0, 8, 16});
  const double without = contour_distance(contours, organ).mean_mm;
  for (const DrawnContour& hole : cuts(egg({6, 5, 5}, {2, 1, 0}), Vec3::UnitZ(), {0})) contours.push_back(hole);
  CHECK(contour_distance(contours, organ).mean_mm < without + 0.05);
}

TEST_CASE("the channel of a keyhole is left out and its inner ring is the rim of a hole") {
  const Mesh organ = egg({20, 16, 24}, {0, 0, 0});
  std::vector<Vec3> outer, inner, keyhole;
  for (int k = 0; k < 60; ++k) {
    const double angle = 2 * std::numbers::pi * k / 60;
    outer.emplace_back(20 * std::cos(angle), 16 * std::sin(angle), 0);
    inner.emplace_back(6 * std::cos(angle), -5 * std::sin(angle), 0);
  }
  const Vec3 halfway = (outer.front() + inner.front()) / 2;
  // It begins within the channel, which has a corner.
  keyhole = {halfway};
  keyhole.insert(keyhole.end(), inner.begin(), inner.end());
  keyhole.insert(keyhole.end(), {inner.front(), halfway});
  keyhole.insert(keyhole.end(), outer.begin(), outer.end());
  keyhole.push_back(outer.front());
  const auto split = sampled_contours({{.curve = {.points = keyhole}}}, 200).samples;
  const auto apart = sampled_contours({{.curve = {.points = inner}}, {.curve = {.points = outer}}}, 200).samples;
  REQUIRE(split.size() == apart.size());
  double off = 0;
  for (std::size_t k = 0; k < split.size(); ++k) {
    off = std::max(off, (split[k].at - apart[k].at).norm());
    CHECK(split[k].hole == apart[k].hole);
    CHECK((split[k].outward - apart[k].outward).norm() < 1e-9);
  }
  CHECK(off < 1e-9);
  // The same with a slit of 0.05 mm between the two ways, as some programs leave it.
  std::vector<Vec3> slit = {halfway};
  slit.insert(slit.end(), inner.begin(), inner.end());
  slit.insert(slit.end(), {inner.front() + Vec3(0, 0.05, 0), halfway + Vec3(0, 0.05, 0)});
  slit.insert(slit.end(), outer.begin(), outer.end());
  slit.push_back(outer.front() + Vec3(0, 0.05, 0));
  const auto with_slit = sampled_contours({{.curve = {.points = slit}}}, 200).samples;
  CHECK(std::ranges::count_if(with_slit, [](const ContourSample& one) { return one.hole; }) ==
        std::ranges::count_if(apart, [](const ContourSample& one) { return one.hole; }));
  CHECK(std::ranges::none_of(with_slit, [](const ContourSample& one) {
    const double across = (one.at.array() / Eigen::Array3d(20, 16, 1)).matrix().head<2>().norm();
    return one.at.head<2>().norm() > 6.5 && across < 0.95;  // within the channel
  }));
  // A line that a curve runs there and back without a hole stays.
  std::vector<Vec3> spike = outer;
  spike.insert(spike.end(), {outer.front(), {30, 0, 0}});
  const auto kept = sampled_contours({{.curve = {.points = spike}}}, 200).samples;
  CHECK(std::ranges::any_of(kept, [](const ContourSample& one) { return one.at.x() > 25; }));
}

TEST_CASE("contours correct a label where both say something") {
  const Mesh organ = egg({20, 16, 24}, {0, 0, 0}), drawn = egg({22, 18, 24}, {0, 0, 0});
  const auto contours = cuts(drawn, Vec3::UnitZ(), {0});
  const auto fit = fit_to_contours_and_boundary(*ball_template(20), contours, mesh_boundary(organ));
  REQUIRE(fit);
  // The label alone would be off by 2 mm there.
  CHECK(contour_distance(contours, fit->mesh).mean_mm < 0.4);
  // Half of the organ's height away from the contour, the label counts.
  double top = 0;
  for (Eigen::Index i = 0; i < fit->mesh.points.rows(); ++i) top = std::max(top, fit->mesh.points(i, 2));
  CHECK(top == doctest::Approx(24).epsilon(0.03));
}

TEST_CASE("no contours are refused") {
  CHECK(says(fit_to_contours(*ball_template(20), {}), "has no contours"));
}

TEST_CASE("curves of 3D Slicer run smoothly through their points and are turned to LPS") {
  const TemporaryFolder folder;
  std::string points;
  for (int k = 0; k < 8; ++k) {
    const double angle = k * std::numbers::pi / 4;
    points += (k > 0 ? "," : "") + std::string(R"({"id":")") + std::to_string(k) + R"(","position":[)" +
              std::to_string(10 * std::cos(angle)) + "," + std::to_string(10 * std::sin(angle)) + ",5]}";
  }
  write_text(folder.path / "rim.mrk.json",
             R"({"markups":[{"type":"ClosedCurve","coordinateSystem":"RAS","controlPoints":[)" + points + "]}]}");
  const auto read = read_curves(folder.path / "rim.mrk.json");
  REQUIRE(read);
  REQUIRE(read->rois.size() == 1);
  CHECK(read->rois[0].name == "rim");
  REQUIRE(read->rois[0].contours.size() == 1);
  const Contour& curve = read->rois[0].contours[0];
  CHECK(curve.closed);
  CHECK(curve.points[0].isApprox(Vec3(-10, 0, 5)));
  for (const Vec3& p : curve.points) CHECK(p.head<2>().norm() == doctest::Approx(10).epsilon(0.02));
  write_text(folder.path / "points.mrk.json",
             R"({"markups":[{"type":"Fiducial","controlPoints":[{"id":"1","position":[0,0,0]}]}]})");
  CHECK(says(read_curves(folder.path / "points.mrk.json"), "holds no curves"));
}

TEST_CASE("lines of a VTP file are curves and closed ones end where they begin") {
  const TemporaryFolder folder;
  const std::string head =
                        R"(<VTKFile type="PolyData"><PolyData><Piece NumberOfPoints="4" NumberOfLines="2"><Points>)"
                        R"(<DataArray type="Float64" format="ascii">0 0 0 10 0 0 10 10 0 0 10 0</DataArray></Points>)"
                        R"(<Lines><DataArray type="Int64" Name="connectivity" format="ascii">)",
                    tail =
                        R"(</DataArray><DataArray type="Int64" Name="offsets" format="ascii">5 7</DataArray></Lines>)"
                        R"(</Piece></PolyData></VTKFile>)";
  write_text(folder.path / "a.vtp", head + "0 1 2 3 0 1 2" + tail);
  const auto read = read_curves(folder.path / "a.vtp");
  REQUIRE(read);
  REQUIRE(read->rois[0].contours.size() == 2);
  CHECK(read->rois[0].contours[0].closed);
  CHECK(read->rois[0].contours[0].points.size() == 4);
  CHECK_FALSE(read->rois[0].contours[1].closed);
  write_text(folder.path / "b.vtp", head + "0 1 2 3 0 1 9" + tail);
  CHECK(says(read_curves(folder.path / "b.vtp"), "does not hold"));
}
