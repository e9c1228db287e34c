#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace homolog {

/// Connected parts of a set of voxels.
struct VoxelComponents {
  std::vector<std::int32_t> part;  ///< each voxel's part: 0, 1, …; −1 outside the set
  std::vector<std::size_t> sizes;  ///< in voxels
};

/// Voxels that touch belong together: by a face (6), or by a face or an edge (18). Sets inside a surface are joined by
/// faces, sets outside by faces and edges, as marching cubes joins them.
enum class Touching { faces, faces_and_edges };

/// The parts of the voxels where `set` (one value a voxel, i fastest) is not 0, by first voxel.
VoxelComponents connected_components(const std::vector<std::uint8_t>& set, const std::array<int, 3>& dims,
                                     Touching touching);

/// The outcome of a set made one solid body.
struct OneBody {
  std::size_t body = 0;              ///< voxels kept, filled cavities counted
  std::vector<std::size_t> islands;  ///< voxels of each other part, removed; the largest first
  std::size_t cavities = 0;          ///< how many were filled
  std::size_t cavity_voxels = 0;
};

/// Keeps the largest part of `set` only (the first of equal ones) and fills its cavities.
OneBody make_one_body(std::vector<std::uint8_t>& set, const std::array<int, 3>& dims);

}  // namespace homolog
