#include "core/mesh/voxels/isosurface.h"

#include <algorithm>
#include <array>
#include <limits>

#include "core/base/numbers/index.h"
#include "core/mesh/voxels/cube_cases.h"
#include "core/volume/check_volume.h"

namespace homolog {
namespace {

/// One slice of the mask with a margin of one voxel, and each row's first and last voxel inside (first > last: none).
struct Slice {
  int width = 0;
  std::vector<std::uint8_t> inside;
  std::vector<int> first, last;

  Slice(int padded_i, int padded_j)
      : width(padded_i),
        inside(index(padded_i) * index(padded_j), 0),
        first(index(padded_j), no_voxel),
        last(index(padded_j), -1) {}

  const std::uint8_t* row(int j) const { return inside.data() + index(j) * index(width); }
  bool empty() const {
    return std::all_of(last.begin(), last.end(), [](int i) { return i < 0; });
  }
  void set(int i, int j) {
    inside[index(j) * index(width) + index(i)] = 1;
    first[j] = std::min(first[j], i);
    last[j] = i;
  }
  void clear() {
    for (std::size_t j = 0; j < last.size(); ++j) {
      if (last[j] < 0) continue;
      std::fill_n(inside.begin() + static_cast<std::ptrdiff_t>(j * index(width)), width, std::uint8_t{0});
      first[j] = no_voxel;
      last[j] = -1;
    }
  }

 private:
  static constexpr int no_voxel = std::numeric_limits<int>::max() / 2;
};

/// Marching cubes over a padded grid, one layer of cubes after the other. A crossed grid edge gets a vertex in the
/// first cube that has the edge, which has it at its far side (the margin sees to that); later cubes find it, so that
/// indices of two slices are all that is kept. `Crossing(voxel, axis)` says where between `voxel` and the next one
/// along `axis` the surface runs, as a share of that edge; `voxel` is counted on the grid without padding.
template <class Crossing>
class Marcher {
 public:
  Marcher(int padded_i, int padded_j, Crossing crossing)
      : width_(padded_i), height_(padded_j), crossing_(std::move(crossing)) {
    const std::size_t size = index(padded_i) * index(padded_j);
    for (auto& layer : {&along_i_[0], &along_i_[1], &along_j_[0], &along_j_[1], &along_k_}) layer->resize(size);
  }

  /// The cubes between slices k and k + 1.
  void march(const Slice& below, const Slice& above, int k) {
    for (int j = 0; j + 1 < height_; ++j) {
      const std::array rows{below.row(j), below.row(j + 1), above.row(j), above.row(j + 1)};
      const int first = std::min({below.first[j], below.first[j + 1], above.first[j], above.first[j + 1]});
      const int last = std::max({below.last[j], below.last[j + 1], above.last[j], above.last[j + 1]});
      unsigned cube = 0;
      for (int i = first - 1; i <= last; ++i) {
        cube = cube >> 1 & 0x55u;  // the far corners of the cube before are the near ones of this
        for (unsigned r = 0; r < 4; ++r) cube |= static_cast<unsigned>(rows[r][i + 1]) << (2 * r + 1);
        if (cube != 0 && cube != 255) add_cube(cube, {i, j, k});
      }
    }
  }

  const std::vector<Vec3>& vertices() const { return vertices_; }  ///< in voxels of the grid without padding
  const std::vector<std::int32_t>& corners() const { return corners_; }

 private:
  /// The slot of an edge's vertex; `edge` as in CubeCases.
  std::int32_t& vertex_on(unsigned edge, std::array<int, 3> at) {
    const std::size_t axis = edge / 4;
    at[(axis + 1) % 3] += static_cast<int>(edge & 1u);
    at[(axis + 2) % 3] += static_cast<int>(edge >> 1 & 1u);
    auto& layer = axis == 2 ? along_k_ : (axis == 0 ? along_i_ : along_j_)[at[2] % 2];
    return layer[index(at[1]) * index(width_) + index(at[0])];
  }

  void add_cube(unsigned cube, const std::array<int, 3>& at) {
    for (unsigned axis = 0; axis < 3; ++axis) {
      if ((cube >> 7 & 1u) == (cube >> (7 ^ 1u << axis) & 1u)) continue;
      vertex_on(4 * axis + 3, at) = static_cast<std::int32_t>(vertices_.size());
      std::array<int, 3> voxel = at;  // the cube's far corner is `at` on the grid without padding
      --voxel[axis];
      Vec3 vertex(voxel[0], voxel[1], voxel[2]);
      vertex[axis] += crossing_(voxel, axis);
      vertices_.push_back(vertex);
    }
    for (const auto& triangle : cases_.triangles[cube])
      for (const std::uint8_t edge : triangle) corners_.push_back(vertex_on(edge, at));
  }

  int width_, height_;
  Crossing crossing_;
  const CubeCases& cases_ = cube_cases();
  std::array<std::vector<std::int32_t>, 2> along_i_, along_j_;  ///< vertices of even and odd slices
  std::vector<std::int32_t> along_k_;
  std::vector<Vec3> vertices_;
  std::vector<std::int32_t> corners_;
};

/// The surface between the voxels that `fill_slice(k, slice)` sets and the others.
template <class FillSlice, class Crossing>
Result<Mesh> marched(const VolumeGeometry& grid, FillSlice fill_slice, Crossing crossing) {
  Marcher<Crossing> marcher(grid.dims[0] + 2, grid.dims[1] + 2, std::move(crossing));
  Slice below(grid.dims[0] + 2, grid.dims[1] + 2), above = below;
  for (int k = -1; k < grid.dims[2]; ++k) {  // slice k of the grid is slice k + 1 of the padded one
    above.clear();
    if (k + 1 < grid.dims[2]) fill_slice(k + 1, above);
    if (!below.empty() || !above.empty()) marcher.march(below, above, k + 1);
    std::swap(below, above);
  }
  Mesh mesh;
  mesh.points.resize(static_cast<Eigen::Index>(marcher.vertices().size()), 3);
  for (Eigen::Index v = 0; v < mesh.points.rows(); ++v) mesh.points.row(v) = grid.to_mm(marcher.vertices()[v]);
  Triangles triangles =
      Eigen::Map<const Triangles>(marcher.corners().data(), static_cast<Eigen::Index>(marcher.corners().size() / 3), 3);
  if (grid.direction.determinant() < 0) triangles.col(1).swap(triangles.col(2));
  auto topology = Topology::make(mesh.points.rows(), std::move(triangles));
  if (!topology) return fail(topology.error());
  mesh.topology = std::move(*topology);
  return mesh;
}

}  // namespace

namespace {

/// 0.5 less the values of a soft mask's frame.
std::vector<float> zero_at_level(const Volume& mask, int frame) {
  const auto& shares = std::get<std::vector<float>>(mask.data);
  const std::size_t count = mask.geometry.voxels();
  std::vector<float> values(count);
  std::transform(shares.begin() + static_cast<std::ptrdiff_t>(count * index(frame)),
                 shares.begin() + static_cast<std::ptrdiff_t>(count * index(frame + 1)), values.begin(),
                 [](float share) { return 0.5F - share; });
  return values;
}

}  // namespace

Result<Mesh> mask_surface(const Volume& mask, int label, int frame) {
  if (auto there = check_frame_of(mask, frame); !there) return fail(there.error());
  if (mask.soft && (label == 1 || label == every_label)) {
    const std::vector<float> values = zero_at_level(mask, frame);
    if (std::any_of(values.begin(), values.end(), [](float value) { return value < 0; }))
      return zero_surface(values, mask.geometry);
  }
  const int size_i = mask.geometry.dims[0], size_j = mask.geometry.dims[1], size_k = mask.geometry.dims[2];
  bool occurs = false;
  const auto fill_slice = [&](int k, Slice& slice) {
    const std::size_t start = (index(frame) * index(size_k) + index(k)) * index(size_j) * index(size_i);
    std::visit(
        [&](const auto& voxels) {
          auto voxel = voxels.begin() + static_cast<std::ptrdiff_t>(start);
          for (int j = 1; j <= size_j; ++j)
            for (int i = 1; i <= size_i; ++i)
              if (has_label(*voxel++, label)) {
                slice.set(i, j);
                occurs = true;
              }
        },
        mask.data);
  };
  auto surface = marched(mask.geometry, fill_slice, [](const std::array<int, 3>&, unsigned) { return 0.5; });
  if (!occurs) return fail("", label_name(label) + " does not occur in the label map; name one that does");
  return surface;
}

Result<Mesh> zero_surface(std::span<const float> values, const VolumeGeometry& grid) {
  if (values.size() != grid.voxels())
    return fail("", "the grid has other voxels than there are values; give a value of each voxel");
  const std::array<std::size_t, 3> stride{1, index(grid.dims[0]), index(grid.dims[0]) * index(grid.dims[1])};
  const auto fill_slice = [&](int k, Slice& slice) {
    const float* value = values.data() + index(k) * stride[2];
    for (int j = 1; j <= grid.dims[1]; ++j)
      for (int i = 1; i <= grid.dims[0]; ++i)
        if (*value++ < 0) slice.set(i, j);
  };
  const auto crossing = [&](const std::array<int, 3>& voxel, unsigned axis) {
    if (voxel[axis] < 0 || voxel[axis] + 1 >= grid.dims[axis]) return 0.5;
    const std::size_t v = index(voxel[0]) + index(voxel[1]) * stride[1] + index(voxel[2]) * stride[2];
    const double here = values[v], there = values[v + stride[axis]];
    return std::clamp(here / (here - there), 0.01, 0.99);  // apart from the corner, where vertices would coincide
  };
  return marched(grid, fill_slice, crossing);
}

}  // namespace homolog
