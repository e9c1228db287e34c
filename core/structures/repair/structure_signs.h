#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "core/structures/fitting/fit_set.h"
#include "core/structures/repair/voxel_body.h"

namespace homolog {

/// Voxels of one layer of a label map, as they would be changed.
struct VoxelChange {
  std::size_t voxel = 0;  ///< its number in the frame, i fastest
  int from = 0, to = 0;
};

/// Signs that tell whether a structure of a label map is right, against its fit and against the shape that its
/// neighbours expect of it. All are shares of its voxels or of the expected ones, unless something else is said.
struct StructureSigns {
  double islands = 0;      ///< apart from the largest part
  std::size_t specks = 0;  ///< how many parts they are
  double holes = 0;        ///< deep within the fit, without a label
  double bridges = 0;      ///< far outside of the fit, but joined to the structure
  /// Narrow ways into the expected shape, which a fit may follow, and thin parts outside of it and of the fit.
  double tunnels = 0, bars = 0;
  double bar_reach = 0;  ///< how far the longest such part juts out of both, as a share of its size
  double volume = 0;     ///< logarithm of the volume against the expected one, less the median of that of all
  double lacking = 0;    ///< share of the expected shape without a label, far from the structure
  double gap = 0;        ///< how far from the structure a large part that lacks reaches, as a share of its size
  double beyond = 0;     ///< share of the expected shape outside of the map
  double at_border = 0;  ///< share of its voxels in the outermost slices of the map
  std::map<std::size_t, double> lost_to;  ///< by another structure's place in the set: voxels with its label that are
                                          ///< deeper in this one's expected shape than in its own
  /// How the signs would be mended.
  std::vector<VoxelChange> without_islands, without_holes, without_bridges, without_bars;
};

/// Returns the signs of each structure of a set, in its order: of those that have a fit as they are found in the map,
/// of the others the values above. `progress` may cancel the work, as there.
std::vector<StructureSigns> structure_signs(const SetOfTemplates& set, const VolumeRead& map, int frame,
                                            const SetInMap& subject, const FittedSet& fitted,
                                            const std::vector<std::optional<Mesh>>& expected,
                                            const Progress* progress = nullptr);

}  // namespace homolog
