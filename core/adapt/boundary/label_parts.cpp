#include "core/adapt/boundary/label_parts.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/mesh/voxels/isosurface.h"
#include "core/template_making/voxel_components.h"

namespace homolog {

namespace {

/// Fills what no path of voxels outside joins to the grid's first corner, which lies in the margin.
void fill_cavities(std::vector<std::uint8_t>& inside, const std::array<int, 3>& dims) {
  std::vector<std::uint8_t> outside(inside.size());
  std::transform(inside.begin(), inside.end(), outside.begin(), [](std::uint8_t v) { return v == 0 ? 1 : 0; });
  const auto parts = connected_components(outside, dims, Touching::faces_and_edges).part;
  for (std::size_t v = 0; v < inside.size(); ++v)
    if (parts[v] > 0) inside[v] = 1;
}

/// Whether what is inside reaches the label map's first or last plane, as far as the whole label does.
void keep_touches(LabelBody& region, const VolumeGeometry& whole) {
  std::array<bool, 6> touches{};
  const auto& dims = region.grid.dims;
  for (int k = 0; k < dims[2]; ++k)
    for (int j = 0; j < dims[1]; ++j)
      for (int i = 0; i < dims[0]; ++i) {
        if (region.inside[region.grid.index(i, j, k)] == 0) continue;
        const Vec3 at = whole.to_voxel(region.grid.to_mm(Vec3(i, j, k)));
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const auto a = static_cast<Eigen::Index>(axis);
          const double block = region.grid.spacing_mm[a] / whole.spacing_mm[a];
          touches[2 * axis] |= at[a] < 0.5 * block;
          touches[2 * axis + 1] |= at[a] > whole.dims[axis] - 1 - 0.5 * block;
        }
      }
  for (std::size_t side = 0; side < 6; ++side) region.touches[side] = region.touches[side] && touches[side];
}

}  // namespace

Result<CutOutParts> label_parts(const Volume& mask, int label, int frame, const LabelExtent& extent, double spacing_mm,
                                double margin_mm, const LabelParts& parts) {
  auto whole = whole_label(mask, label, frame, extent, spacing_mm, margin_mm);
  if (!whole) return fail(whole.error());
  CutOutParts cut{std::move(*whole), {}};
  LabelBody& region = cut.region;
  const VoxelComponents found = connected_components(region.inside, region.grid.dims, Touching::faces);
  std::vector<std::size_t> order(found.sizes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return found.sizes[a] > found.sizes[b]; });
  if (parts.rank >= order.size())
    return fail("", label_name(label) + " has only " + std::to_string(order.size()) + " parts; name a larger one");
  cut.left_out.alike = static_cast<std::size_t>(std::count_if(
      found.sizes.begin(), found.sizes.end(), [&](std::size_t size) { return 2 * size > found.sizes[order.front()]; }));
  if (parts.all) {
    fill_cavities(region.inside, region.grid.dims);
    return cut;
  }
  const auto total = std::accumulate(found.sizes.begin(), found.sizes.end(), std::size_t{0});
  const std::size_t kept = order[parts.rank];
  cut.left_out.count = order.size() - 1;
  cut.left_out.share = 1 - static_cast<double>(found.sizes[kept]) / static_cast<double>(total);
  for (std::size_t v = 0; v < region.inside.size(); ++v)
    region.inside[v] = found.part[v] == static_cast<std::int32_t>(kept) ? 1 : 0;
  region.body = make_one_body(region.inside, region.grid.dims);
  keep_touches(region, mask.geometry);
  return cut;
}

}  // namespace homolog
