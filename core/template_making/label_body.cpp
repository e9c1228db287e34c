#include "core/template_making/label_body.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
#include <string>

#include "core/base/numbers/index.h"
#include "core/base/processes/parallel.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/mesh/voxels/voxelise.h"

namespace homolog {
namespace {

constexpr double most_voxels = 16e6;
/// A surface's share of the area of its voxels' faces, on average over all directions.
constexpr double face_share = 2.0 / 3.0;

/// Calls `visit(i, j, k)` for every voxel that has the label.
template <class Visit>
void for_each_voxel(const Volume& mask, int label, int frame, const LabelExtent& box, Visit visit) {
  const std::size_t first = index(frame) * mask.geometry.voxels();
  std::visit(
      [&](const auto& voxels) {
        for (int k = box.first[2]; k <= box.last[2]; ++k)
          for (int j = box.first[1]; j <= box.last[1]; ++j) {
            const std::size_t row = first + mask.geometry.index(0, j, k);
            for (int i = box.first[0]; i <= box.last[0]; ++i)
              if (has_label(voxels[row + index(i)], label)) visit(i, j, k);
          }
      },
      mask.data);
}

/// A grid whose voxels are blocks of a label map's.
struct Blocks {
  std::array<int, 3> size{}, first{}, dims{};  ///< voxels a block; the voxel that the first block begins with; blocks
  double count() const { return 1.0 * dims[0] * dims[1] * dims[2]; }
  std::size_t voxels_of_one() const { return index(size[0]) * index(size[1]) * index(size[2]); }
  int holding(int voxel, std::size_t axis) const { return (voxel - first[axis]) / size[axis]; }
};

Blocks blocks_of(const VolumeGeometry& whole, const LabelExtent& extent, double spacing_mm, double margin_mm) {
  Blocks blocks;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double voxel_mm = whole.spacing_mm[static_cast<Eigen::Index>(axis)];
    const int size = blocks.size[axis] = std::max(1, static_cast<int>(spacing_mm / voxel_mm));
    const int margin = std::max(2, static_cast<int>(std::ceil(margin_mm / (size * voxel_mm))));
    blocks.first[axis] = extent.first[axis] - margin * size;
    blocks.dims[axis] = (extent.last[axis] - extent.first[axis]) / size + 1 + 2 * margin;
  }
  return blocks;
}

/// Whether something inside lies in the plane `at` of an axis.
bool reaches(const LabelBody& region, std::size_t axis, int at) {
  const auto& dims = region.grid.dims;
  const std::size_t row = index(dims[0]), slice = row * index(dims[1]);
  const std::array<std::size_t, 3> stride{1, row, slice};
  const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  for (std::size_t i = 0; i < index(dims[u]); ++i)
    for (std::size_t j = 0; j < index(dims[v]); ++j)
      if (region.inside[index(at) * stride[axis] + i * stride[u] + j * stride[v]] != 0) return true;
  return false;
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
          ++extent.voxels;
          const std::ptrdiff_t v = frame_start + i + j * stride[1] + k * stride[2];
          for (std::size_t axis = 0; axis < 3; ++axis) {
            extent.first[axis] = std::min(extent.first[axis], at[axis]);
            extent.last[axis] = std::max(extent.last[axis], at[axis]);
            const auto same = [&](std::ptrdiff_t n) { return has_label(voxels[n], label); };
            if (at[axis] == 0 || !same(v - stride[axis])) extent.area_mm2 += face_mm2[axis];
            if (at[axis] + 1 == dims[axis] || !same(v + stride[axis])) extent.area_mm2 += face_mm2[axis];
          }
        });
      },
      mask.data);
  extent.area_mm2 *= face_share;
  return extent;
}

double organ_size_mm(const LabelExtent& extent) {
  return std::sqrt(extent.area_mm2);
}

std::map<int, double> label_sizes_mm(const Volume& mask, int frame) {
  const auto& dims = mask.geometry.dims;
  const Vec3& spacing = mask.geometry.spacing_mm;
  const std::array<double, 3> face_mm2{spacing[1] * spacing[2], spacing[0] * spacing[2], spacing[0] * spacing[1]};
  const std::array<std::size_t, 3> stride{1, index(dims[0]), index(dims[0]) * index(dims[1])};
  std::map<int, double> area;
  std::visit(
      [&](const auto& voxels) {
        const auto* data = voxels.data() + index(frame) * mask.geometry.voxels();
        const auto add = [&](int one, int other, double mm2) {
          if (one == other) return;
          if (one != 0) area[one] += mm2;
          if (other != 0) area[other] += mm2;
          if ((one == 0) != (other == 0)) area[every_label] += mm2;
        };
        const auto label_at = [&](std::size_t v) { return rounded_label(static_cast<double>(data[v])); };
        for (int k = 0; k < dims[2]; ++k)
          for (int j = 0; j < dims[1]; ++j)
            for (int i = 0; i < dims[0]; ++i) {
              const std::array<int, 3> at{i, j, k};
              const std::size_t v = index(i) + index(j) * stride[1] + index(k) * stride[2];
              for (std::size_t axis = 0; axis < 3; ++axis) {
                if (at[axis] == 0) add(0, label_at(v), face_mm2[axis]);
                const bool last = at[axis] + 1 == dims[axis];
                if (last || data[v] != data[v + stride[axis]])
                  add(label_at(v), last ? 0 : label_at(v + stride[axis]), face_mm2[axis]);
              }
            }
      },
      mask.data);
  for (auto& [label, size] : area) size = std::sqrt(size * face_share);
  return area;
}

double worked_spacing_mm(const Volume& mask, const LabelExtent& extent, double edge_mm, double margin_mm) {
  const Vec3& voxel_mm = mask.geometry.spacing_mm;
  double volume_mm3 = 1;
  for (std::size_t axis = 0; axis < 3; ++axis)
    volume_mm3 *=
        (extent.last[axis] - extent.first[axis] + 1) * voxel_mm[static_cast<Eigen::Index>(axis)] + 2 * margin_mm;
  return std::max({edge_mm / 3, 0.5 * voxel_mm.minCoeff(), std::cbrt(std::max(0.0, volume_mm3) / most_voxels)});
}

namespace {

/// The mean value of a soft mask in each block; beyond the mask there is nothing.
std::vector<float> mean_shares(const Volume& mask, int frame, const Blocks& blocks) {
  const auto& dims = mask.geometry.dims;
  const float* shares = std::get<std::vector<float>>(mask.data).data() + index(frame) * mask.geometry.voxels();
  std::vector<float> means(index(blocks.dims[0]) * index(blocks.dims[1]) * index(blocks.dims[2]));
  const auto all_of_block = static_cast<double>(blocks.voxels_of_one());
  std::size_t at = 0;
  std::array<int, 3> first{}, last{};  // the voxels of a block that the mask has
  const auto take = [&](std::size_t axis, int block) {
    first[axis] = std::max(0, blocks.first[axis] + block * blocks.size[axis]);
    last[axis] = std::min(dims[axis], blocks.first[axis] + (block + 1) * blocks.size[axis]) - 1;
  };
  for (int bk = 0; bk < blocks.dims[2]; ++bk)
    for (int bj = 0; bj < blocks.dims[1]; ++bj)
      for (int bi = 0; bi < blocks.dims[0]; ++bi, ++at) {
        take(0, bi), take(1, bj), take(2, bk);
        double sum = 0;
        for (int k = first[2]; k <= last[2]; ++k)
          for (int j = first[1]; j <= last[1]; ++j)
            for (int i = first[0]; i <= last[0]; ++i) sum += static_cast<double>(shares[mask.geometry.index(i, j, k)]);
        means[at] = static_cast<float>(sum / all_of_block);
      }
  return means;
}

/// Values whose zero is the surface of a soft mask, as far as `inside` goes: parts that were left out are outside, and
/// cavities that were filled inside.
std::vector<float> values_of(const LabelBody& region) {
  std::vector<float> values(region.shares.size());
  for (std::size_t v = 0; v < values.size(); ++v) {
    const bool inside = region.inside[v] != 0;
    values[v] = inside == (region.shares[v] > 0.5F) ? 0.5F - region.shares[v] : inside ? -0.5F : 0.5F;
  }
  return values;
}

/// A label with a margin around it: its largest part alone, cavities filled, or all of it.
Result<LabelBody> label_cut_out(const Volume& mask, int label, int frame, const LabelExtent& extent, double spacing_mm,
                                double margin_mm, bool one_body) {
  if (extent.area_mm2 <= 0) return fail("", label_name(label) + " does not occur in the label map; name one that does");
  const VolumeGeometry& whole = mask.geometry;
  Blocks blocks = blocks_of(whole, extent, spacing_mm, margin_mm);
  while (blocks.count() > most_voxels) {
    spacing_mm *= 1.25;
    blocks = blocks_of(whole, extent, spacing_mm, margin_mm);
  }
  LabelBody region;
  region.grid.direction = whole.direction;
  region.grid.dims = blocks.dims;
  Vec3 origin;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    region.grid.spacing_mm[a] = blocks.size[axis] * whole.spacing_mm[a];
    origin[a] = blocks.first[axis] + 0.5 * (blocks.size[axis] - 1);
  }
  region.grid.origin_mm = whole.to_mm(origin);

  std::vector<std::uint32_t> count(region.grid.voxels(), 0);
  for_each_voxel(mask, label, frame, extent, [&](int i, int j, int k) {
    ++count[region.grid.index(blocks.holding(i, 0), blocks.holding(j, 1), blocks.holding(k, 2))];
  });
  const std::size_t half = (blocks.voxels_of_one() + 1) / 2;
  region.inside.resize(count.size());
  std::transform(count.begin(), count.end(), region.inside.begin(),
                 [half](std::uint32_t n) { return static_cast<std::uint8_t>(n >= half); });
  if (mask.soft) {
    region.shares = mean_shares(mask, frame, blocks);
    std::transform(region.shares.begin(), region.shares.end(), region.inside.begin(),
                   [](float share) { return static_cast<std::uint8_t>(share > 0.5F); });
  }
  if (one_body) region.body = make_one_body(region.inside, region.grid.dims);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (axis == 2 && mask.empty_beyond_slices) continue;
    const int last = whole.dims[axis] - 1;
    region.touches[2 * axis] = extent.first[axis] == 0 && reaches(region, axis, blocks.holding(0, axis));
    region.touches[2 * axis + 1] = extent.last[axis] == last && reaches(region, axis, blocks.holding(last, axis));
  }
  return region;
}

}  // namespace

Result<LabelBody> label_body(const Volume& mask, int label, int frame, const LabelExtent& extent, double spacing_mm,
                             double margin_mm) {
  return label_cut_out(mask, label, frame, extent, spacing_mm, margin_mm, true);
}

Result<LabelBody> whole_label(const Volume& mask, int label, int frame, const LabelExtent& extent, double spacing_mm,
                              double margin_mm) {
  return label_cut_out(mask, label, frame, extent, spacing_mm, margin_mm, false);
}

std::size_t voxels_off(const LabelBody& region, const Mesh& mesh) {
  const auto& dims = region.grid.dims;
  const std::vector<std::uint8_t> covered = voxelise(mesh, region.grid);
  const SurfaceSearch search(mesh);
  const double far_mm = 2 * region.grid.spacing_mm.maxCoeff();
  const auto at = [&](int i, int j, int k) { return region.grid.index(i, j, k); };
  // Whether the mesh holds a voxel at most two away along an axis: then it is near, and need not be searched for.
  const auto near = [&](int i, int j, int k) {
    for (int d = -2; d <= 2; ++d) {
      if (i + d >= 0 && i + d < dims[0] && covered[at(i + d, j, k)] != 0) return true;
      if (j + d >= 0 && j + d < dims[1] && covered[at(i, j + d, k)] != 0) return true;
      if (k + d >= 0 && k + d < dims[2] && covered[at(i, j, k + d)] != 0) return true;
    }
    return false;
  };
  std::size_t off = 0;
  for (int k = 0; k < dims[2]; ++k)
    for (int j = 0; j < dims[1]; ++j)
      for (int i = 0; i < dims[0]; ++i)
        if (region.inside[at(i, j, k)] != 0 && !near(i, j, k))
          off += search.nearest(region.grid.to_mm(Vec3(i, j, k))).distance_mm > far_mm;
  return off;
}

Result<Mesh> boundary_of(const LabelBody& region) {
  if (!region.shares.empty()) return zero_surface(values_of(region), region.grid);
  Volume body;
  body.geometry = region.grid;
  body.data = region.inside;
  return mask_surface(body, 1);
}

LevelSet signed_distance(const LabelBody& region) {
  LevelSet by_voxels = signed_distance(region.inside, region.grid);
  const auto surface = region.shares.empty() ? fail("", "") : boundary_of(region);
  if (!surface) return by_voxels;
  // Beside the surface the distances are exact, so that it lies where the values say; farther off those of the voxels
  // are near enough.
  const SurfaceSearch search(*surface);
  const auto& dims = region.grid.dims;
  std::vector<float> values = by_voxels.values();
  const auto at = [&](int i, int j, int k) { return region.grid.index(i, j, k); };
  const auto is_beside = [&](int i, int j, int k) {
    for (int c = std::max(0, k - 1); c <= std::min(dims[2] - 1, k + 1); ++c)
      for (int b = std::max(0, j - 1); b <= std::min(dims[1] - 1, j + 1); ++b)
        for (int a = std::max(0, i - 1); a <= std::min(dims[0] - 1, i + 1); ++a)
          if (region.inside[at(a, b, c)] != region.inside[at(i, j, k)]) return true;
    return false;
  };
  in_parallel(dims[2], [&](int first, int last) {
    for (int k = first; k < last; ++k)
      for (int j = 0; j < dims[1]; ++j)
        for (int i = 0; i < dims[0]; ++i) {
          if (!is_beside(i, j, k)) continue;
          const double mm = search.nearest(region.grid.to_mm(Vec3(i, j, k))).distance_mm;
          values[at(i, j, k)] = static_cast<float>(region.inside[at(i, j, k)] != 0 ? -mm : mm);
        }
  });
  return {region.grid, std::move(values)};
}

std::optional<std::string> PartsLeftOut::warning(int label, const std::string& taken,
                                                 const std::string& command) const {
  constexpr double said_share = 0.01;  // crumbs below this are left out without a word
  if (count == 0 || share < said_share) return std::nullopt;
  char percent[32];
  std::snprintf(percent, sizeof percent, "%.0f %%", 100 * share);
  std::string text = label_name(label) + " has " + std::to_string(count + 1) + " parts";
  if (alike > 1) text += ", " + std::to_string(alike) + " of about one size";
  return text + "; " + taken + " was taken, and the others with " + percent + " of its volume are left out; " +
         command + "--parts all keeps them";
}

std::optional<std::string> several_parts(const LabelBody& region, int label) {
  const auto& islands = region.body.islands;
  const auto others = static_cast<double>(std::accumulate(islands.begin(), islands.end(), std::size_t{0}));
  const auto alike = static_cast<std::size_t>(
      std::count_if(islands.begin(), islands.end(), [&](std::size_t voxels) { return 2 * voxels > region.body.body; }));
  const PartsLeftOut parts{islands.size(), others / (others + static_cast<double>(region.body.body)), 1 + alike};
  auto said = parts.warning(label, "the largest", "homolog template ");
  if (said && alike > 0) *said += ", or give them labels of their own";
  return said;
}

std::vector<MapSide> sides_that_cut(const LabelBody& body, const VolumeGeometry& map) {
  std::vector<MapSide> sides;
  for (std::size_t side = 0; side < 6; ++side) {
    if (!body.touches[side]) continue;
    const auto axis = static_cast<Eigen::Index>(side / 2);
    const bool last = side % 2 == 1;
    Vec3 face = Vec3::Zero();
    face[axis] = last ? map.dims[side / 2] - 0.5 : -0.5;
    const Vec3 outward = map.direction.col(axis) * (last ? 1 : -1);
    sides.push_back({outward, outward.dot(map.to_mm(face)), axis});
  }
  return sides;
}

}  // namespace homolog
