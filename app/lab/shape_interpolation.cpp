#include "app/lab/shape_interpolation.h"

#include <algorithm>
#include <cmath>

#include "core/base/numbers/nearest_on_segment.h"
#include "core/mesh/voxels/isosurface.h"

namespace homolog {

namespace {

/// The curves of one plane in its coordinates, and how high it lies.
struct FlatCurves {
  double height_mm = 0;
  std::vector<std::vector<Vec3>> curves;

  /// mm, negative inside by exclusive or.
  double signed_distance_mm(const Vec3& p) const {
    double nearest_mm = 1e9;
    bool inside = false;
    for (const auto& curve : curves)
      for (std::size_t k = 0; k < curve.size(); ++k) {
        const Vec3 &a = curve[k], &b = curve[(k + 1) % curve.size()];
        nearest_mm = std::min(nearest_mm, (a + nearest_on_segment(p, a, b) * (b - a) - p).norm());
        if ((a.y() <= p.y()) != (b.y() <= p.y()) && p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
          inside = !inside;
      }
    return inside ? -nearest_mm : nearest_mm;
  }
};

}  // namespace

Result<Mesh> interpolated_shape(const std::vector<DrawnContour>& contours, double voxel_mm) {
  const ContourSamples samples = sampled_contours(contours, 1);
  if (samples.planes.empty()) return fail("", "has no curves in a plane");
  Mat3 frame;
  frame.col(2) = samples.planes.front().normal;
  frame.col(0) = frame.col(2).unitOrthogonal();
  frame.col(1) = frame.col(2).cross(frame.col(0));
  std::vector<FlatCurves> planes;
  Box box;
  for (const DrawnContour& one : contours) {
    std::vector<Vec3> flat;
    for (const Vec3& p : one.curve.points) box.extend(flat.emplace_back(frame.transpose() * p));
    const double height_mm = flat.front().z();
    for (Vec3& p : flat) p.z() = 0;
    auto plane = std::find_if(planes.begin(), planes.end(),
                              [&](const FlatCurves& known) { return std::abs(known.height_mm - height_mm) < 0.01; });
    if (plane == planes.end()) plane = planes.insert(plane, FlatCurves{height_mm, {}});
    plane->curves.push_back(std::move(flat));
  }
  if (planes.size() < 2) return fail("", "has curves in one plane alone");
  std::sort(planes.begin(), planes.end(), [](auto& a, auto& b) { return a.height_mm < b.height_mm; });
  const double apart_mm = (planes.back().height_mm - planes.front().height_mm) / static_cast<double>(planes.size() - 1);
  const double beyond_mm = apart_mm / 2;
  constexpr double margin_mm = 6;
  VolumeGeometry grid;
  grid.spacing_mm = Vec3::Constant(voxel_mm);
  grid.direction = frame;
  const Vec3 low = box.min() - Vec3(margin_mm, margin_mm, beyond_mm + 2 * voxel_mm);
  const Vec3 extent = box.max() + Vec3(margin_mm, margin_mm, beyond_mm + 2 * voxel_mm) - low;
  for (int a = 0; a < 3; ++a) grid.dims[a] = 1 + static_cast<int>(extent[a] / voxel_mm);
  grid.origin_mm = frame * low;
  const auto nx = static_cast<std::size_t>(grid.dims[0]), ny = static_cast<std::size_t>(grid.dims[1]);
  std::vector<std::vector<float>> maps;
  for (const FlatCurves& plane : planes) {
    auto& map = maps.emplace_back(nx * ny);
    for (std::size_t j = 0; j < ny; ++j)
      for (std::size_t i = 0; i < nx; ++i)
        map[j * nx + i] = static_cast<float>(plane.signed_distance_mm(
            Vec3(low.x() + voxel_mm * static_cast<double>(i), low.y() + voxel_mm * static_cast<double>(j), 0)));
  }
  std::vector<float> values(grid.voxels());
  for (int k = 0; k < grid.dims[2]; ++k) {
    const double height_mm = low.z() + voxel_mm * k;
    std::size_t above = 1;
    while (above + 1 < planes.size() && planes[above].height_mm < height_mm) ++above;
    const double from = planes[above - 1].height_mm, to = planes[above].height_mm;
    const double share = std::clamp((height_mm - from) / (to - from), 0.0, 1.0);
    const double out_mm =
        std::max(planes.front().height_mm - beyond_mm - height_mm, height_mm - planes.back().height_mm - beyond_mm);
    for (std::size_t p = 0; p < nx * ny; ++p) {
      const double between = (1 - share) * maps[above - 1][p] + share * maps[above][p];
      values[static_cast<std::size_t>(k) * nx * ny + p] = static_cast<float>(std::max(between, out_mm));
    }
  }
  return zero_surface(values, grid);
}

}  // namespace homolog
