#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/mesh/topology.h"
#include "core/volume/volume.h"

namespace homolog {

/// Which part of a label's surface is meant, by the labels beyond it.
struct FacedLabels {
  std::vector<int> values;  ///< 0: what has no label
  bool kept = true;         ///< the part that faces them, else all but that
};

/// The part of a label's surface that faces others, an open mesh of one or more pieces. A place faces what lies beyond
/// it along its normal, within two voxels; the edges are evened out along the surface by about two voxels. Space beyond
/// the label map counts as another label. `surface`: of `label` in `frame` [label_boundary], LPS mm. Errors: the
/// surface faces none of them, or nothing else.
Result<Mesh> faced_part(const Mesh& surface, const Volume& labels, int label, int frame, const FacedLabels& faced);

/// The warning that the largest piece of such a part is taken, and what share of its area that leaves out; nothing
/// where it is hardly any. `part` becomes that piece.
std::optional<std::string> take_largest_piece(Mesh& part, int label);

}  // namespace homolog
