#include "core/mesh/files/curve_io.h"

#include <doctest/doctest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/must.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

using namespace homolog;
namespace fs = std::filesystem;

namespace {

using CurvePoints = std::vector<std::array<double, 3>>;

const CurvePoints five_points{{0, 0, 0}, {10, 1, 2}, {14, 9, 3}, {5, 15, 1}, {-3, 8, -2}};

nlohmann::json slicer_curve(const std::string& type, const CurvePoints& points) {
  nlohmann::json placed = nlohmann::json::array();
  for (const auto& point : points) placed.push_back({{"id", "1"}, {"position", point}});
  return {{"type", type}, {"coordinateSystem", "LPS"}, {"controlPoints", placed}};
}

fs::path put_markups(const fs::path& folder, const nlohmann::json& markups) {
  std::ofstream(folder / "drawn.mrk.json") << nlohmann::json{{"markups", markups}};
  return folder / "drawn.mrk.json";
}

/// The farthest that a curve lies from points that VTK gives at every quarter of the way from one point to the next.
double off_quarters(const Contour& curve, const CurvePoints& quarters) {
  double farthest = 0;
  REQUIRE(curve.points.size() + (curve.closed ? 0 : 1) >= 2 * quarters.size());
  for (std::size_t k = 0; k < quarters.size(); ++k)
    farthest = std::max(farthest, (curve.points[2 * k] - Vec3(quarters[k].data())).norm());
  return farthest;
}

}  // namespace

TEST_CASE("curves of 3D Slicer run where VTK's cardinal spline runs") {
  const TemporaryFolder folder;
  // vtkParametricSpline of VTK 9.1 with ParameterizeByLengthOff, closed and open.
  const CurvePoints closed{{0.000000000, 0.000000000, 0.000000000},    {2.278409091, -0.674715909, 0.619318182},
                           {4.863636364, -0.693181818, 1.136363636},   {7.517045455, -0.115056818, 1.585227273},
                           {10.000000000, 1.000000000, 2.000000000},   {12.082386364, 2.582386364, 2.399147727},
                           {13.568181818, 4.522727273, 2.738636364},   {14.269886364, 6.701704545, 2.958806818},
                           {14.000000000, 9.000000000, 3.000000000},   {12.657670455, 11.267045455, 2.815340909},
                           {10.488636364, 13.227272727, 2.409090909},  {7.825284091, 14.573863636, 1.798295455},
                           {5.000000000, 15.000000000, 1.000000000},   {2.318181818, 14.302556818, 0.058238636},
                           {-0.022727273, 12.693181818, -0.875000000}, {-1.852272727, 10.487215909, -1.620738636},
                           {-3.000000000, 8.000000000, -2.000000000},  {-3.336647727, 5.522727273, -1.892045455},
                           {-2.897727273, 3.250000000, -1.409090909},  {-1.759943182, 1.352272727, -0.721590909}};
  const CurvePoints open{{0.000000000, 0.000000000, 0.000000000},    {1.027622768, -0.039620536, 0.202008929},
                         {3.573660714, -0.022321429, 0.705357143},   {6.832868304, 0.256138393, 1.356026786},
                         {10.000000000, 1.000000000, 2.000000000},   {12.400390625, 2.355468750, 2.507812500},
                         {13.881696429, 4.236607143, 2.848214286},   {14.422154018, 6.499441964, 3.014508929},
                         {14.000000000, 9.000000000, 3.000000000},   {12.636439732, 11.539620536, 2.797991071},
                         {10.524553571, 13.700892857, 2.401785714},  {7.900390625, 15.011718750, 1.804687500},
                         {5.000000000, 15.000000000, 1.000000000},   {2.085100446, 13.439174107, 0.018973214},
                         {-0.479910714, 11.084821429, -0.955357143}, {-2.304966518, 8.938058036, -1.702008929}};
  const auto curves = test::must(read_curves(
      put_markups(folder.path, {slicer_curve("ClosedCurve", five_points), slicer_curve("Curve", five_points)})));
  REQUIRE(curves.rois.front().contours.size() == 2);
  CHECK(curves.rois.front().contours[0].points.size() == 40);
  CHECK(off_quarters(curves.rois.front().contours[0], closed) < 1e-8);
  CHECK(curves.rois.front().contours[1].points.size() == 33);
  CHECK(off_quarters(curves.rois.front().contours[1], open) < 1e-8);
  CHECK(curves.warnings.empty());
}

TEST_CASE("a curve of 3D Slicer that says its type runs straight or is warned about") {
  const TemporaryFolder folder;
  auto straight = slicer_curve("ClosedCurve", five_points), other = straight;
  straight["curveType"] = "linear";
  other["curveType"] = "polynomial";
  const auto curves = test::must(read_curves(put_markups(folder.path, {straight, other})));
  REQUIRE(curves.rois.front().contours.size() == 2);
  CHECK(curves.rois.front().contours[0].points.size() == 5);
  CHECK(curves.rois.front().contours[1].points.size() == 40);
  REQUIRE(curves.warnings.size() == 1);
  CHECK(curves.warnings.front().find("has a curve of the type polynomial") != std::string::npos);
}

TEST_CASE("a curve without points beside others is left out and a file of points alone is refused") {
  const TemporaryFolder folder;
  const auto drawn = slicer_curve("ClosedCurve", five_points), fresh = slicer_curve("ClosedCurve", {});
  const auto curves = test::must(read_curves(put_markups(folder.path, {drawn, fresh})));
  CHECK(curves.rois.front().contours.size() == 1);
  REQUIRE(curves.warnings.size() == 1);
  CHECK(curves.warnings.front().find("has 1 curve without points, which was left out") != std::string::npos);
  CHECK(says(read_curves(put_markups(folder.path, nlohmann::json::array({fresh}))), "closed curve of 0 points"));
  std::ofstream(folder.path / "points.fcsv") << "# Markups fiducial file version = 4.11\n";
  CHECK(says(read_curves(folder.path / "points.fcsv"), "holds points alone and no curves"));
}
