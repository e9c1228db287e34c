#include "core/template/label_region.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/mesh/isosurface.h"

namespace homolog {
namespace {

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

/// Calls `visit(i, j, k)` for every voxel that has the label.
template <class Visit>
void for_each_voxel(const Volume& mask, int label, int frame, const LabelExtent& box, Visit visit) {
  const auto& dims = mask.geometry.dims;
  std::visit(
      [&](const auto& voxels) {
        for (int k = box.first[2]; k <= box.last[2]; ++k)
          for (int j = box.first[1]; j <= box.last[1]; ++j) {
            const std::size_t row =
                ((index(frame) * index(dims[2]) + index(k)) * index(dims[1]) + index(j)) * index(dims[0]);
            for (int i = box.first[0]; i <= box.last[0]; ++i)
              if (has_label(voxels[row + index(i)], label)) visit(i, j, k);
          }
      },
      mask.data);
}

}  // namespace

LabelExtent label_extent(const Volume& mask, int label, int frame) {
  const auto& dims = mask.geometry.dims;
  const Vec3& spacing = mask.geometry.spacing_mm;
  LabelExtent whole, extent;
  whole.last = {dims[0] - 1, dims[1] - 1, dims[2] - 1};
  extent.first.fill(std::numeric_limits<int>::max());
  extent.last.fill(-1);
  const std::array<double, 3> face_mm2{spacing[1] * spacing[2], spacing[0] * spacing[2], spacing[0] * spacing[1]};
  const std::array<std::ptrdiff_t, 3> stride{1, dims[0], static_cast<std::ptrdiff_t>(dims[0]) * dims[1]};
  const auto frame_start = static_cast<std::ptrdiff_t>(index(frame) * mask.geometry.voxels());
  std::visit(
      [&](const auto& voxels) {
        for_each_voxel(mask, label, frame, whole, [&](int i, int j, int k) {
          const std::array<int, 3> at{i, j, k};
          const std::ptrdiff_t v = frame_start + i + j * stride[1] + k * stride[2];
          for (std::size_t axis = 0; axis < 3; ++axis) {
            extent.first[axis] = std::min(extent.first[axis], at[axis]);
            extent.last[axis] = std::max(extent.last[axis], at[axis]);
            const auto same = [&](std::ptrdiff_t n) { return has_label(voxels[static_cast<std::size_t>(n)], label); };
            if (at[axis] == 0 || !same(v - stride[axis])) extent.area_mm2 += face_mm2[axis];
            if (at[axis] + 1 == dims[axis] || !same(v + stride[axis])) extent.area_mm2 += face_mm2[axis];
          }
        });
      },
      mask.data);
  extent.area_mm2 *= 2.0 / 3.0;  // what faces of voxels show too much of, on average over all directions
  return extent;
}

Result<LabelRegion> label_region(const Volume& mask, int label, int frame, double spacing_mm, double margin_mm) {
  const LabelExtent box = label_extent(mask, label, frame);
  if (box.area_mm2 <= 0)
    return fail("", "label " + std::to_string(label) + " does not occur in the label map; name one that does");
  const VolumeGeometry& whole = mask.geometry;
  LabelRegion region;
  region.grid.direction = whole.direction;
  std::array<int, 3> block{}, first{};
  Vec3 origin;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    block[axis] = std::max(1, static_cast<int>(spacing_mm / whole.spacing_mm[a]));
    const double block_mm = block[axis] * whole.spacing_mm[a];
    const int margin = std::max(2, static_cast<int>(std::ceil(margin_mm / block_mm)));
    first[axis] = box.first[axis] - margin * block[axis];
    region.grid.spacing_mm[a] = block_mm;
    region.grid.dims[axis] = (box.last[axis] - box.first[axis]) / block[axis] + 1 + 2 * margin;
    origin[a] = first[axis] + 0.5 * (block[axis] - 1);
    region.touches[2 * axis] = box.first[axis] == 0;
    region.touches[2 * axis + 1] = box.last[axis] + 1 == whole.dims[axis];
  }
  region.grid.origin_mm = whole.to_mm(origin);

  const std::size_t row = index(region.grid.dims[0]), slice = row * index(region.grid.dims[1]);
  std::vector<std::uint16_t> count(region.grid.voxels(), 0);
  for_each_voxel(mask, label, frame, box, [&](int i, int j, int k) {
    auto& n = count[index((i - first[0]) / block[0]) + index((j - first[1]) / block[1]) * row +
                    index((k - first[2]) / block[2]) * slice];
    if (n < std::numeric_limits<std::uint16_t>::max()) ++n;
  });
  const int half = std::min((block[0] * block[1] * block[2] + 1) / 2, 65535);
  region.inside.resize(count.size());
  std::transform(count.begin(), count.end(), region.inside.begin(),
                 [half](std::uint16_t n) { return static_cast<std::uint8_t>(n >= half); });
  region.body = make_one_body(region.inside, region.grid.dims);
  return region;
}

}  // namespace homolog
