#pragma once

#include <string>
#include <vector>

#include "core/template_making/level_set.h"

namespace homolog {

/// A tunnel that is no more: filled across its narrowest place, or opened by severing the strand around it.
struct CutTunnel {
  enum class How { filled, severed };
  How how = How::filled;
  Vec3 at_mm = Vec3::Zero();  ///< middle of the cut
  double width_mm = 0;        ///< width of the tunnel or the strand: a ball of this diameter does not pass
};

/// "one tunnel", "3 tunnels".
std::string count_of_tunnels(int genus);

struct TunnelCut {
  LevelSet surface;
  int genus_before = 0, genus = 0;
  std::vector<CutTunnel> tunnels;
};

struct TunnelLimits {
  int keep = 0;               ///< genus to end with
  double first_below_mm = 5;  ///< narrower ones are cut first; then the width grows to the next two
  double fill_below_mm = 0;   ///< tunnels narrower than this are filled; 0: none
  bool fill_any = false;      ///< wider ones are filled at last too, as a ring's
  double sever_below_mm = 0;  ///< strands thinner than this are severed; 0: none
  double reach_mm = 0;        ///< how far a cut extends to either side of the narrowest place
};

/// Cuts tunnels, the narrowest first, until the genus is `keep` or none is left within the limits. Space that a ball of
/// the tunnel's width cannot enter is filled; matter that such a ball does not fit into is removed. A ball rolls far
/// into the wide hole of a thin ring, however large it is: such holes are filled by a disc. The surface must be one
/// body without cavities.
TunnelCut cut_tunnels(const LevelSet& surface, const TunnelLimits& limits);

/// Genus of the zero level of one body without cavities.
int genus_of(const std::vector<std::uint8_t>& inside, const std::array<int, 3>& dims);

/// Whether taking the middle voxel out of (or putting it into) a 3×3×3 neighbourhood leaves the topology of the
/// surface as it is: a simple point, voxels inside joined by faces, outside by faces and edges
/// [Bertrand and Malandain 1994, A New Characterization of Three-Dimensional Simple Points]. Bit i + 3j + 9k of
/// `inside` says whether a voxel is inside; that of the middle does not count.
bool is_simple(std::uint32_t inside);

}  // namespace homolog
