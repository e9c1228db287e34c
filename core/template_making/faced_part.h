#pragma once

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

/// The part of a label's surface that faces others, an open mesh: its largest piece. A place faces what lies beyond it
/// along its normal, within two voxels; the edges are evened out along the surface by about a voxel. Space beyond the
/// label map counts as another label. `surface`: of `label` in `frame` [label_boundary], LPS mm. Errors: the surface
/// faces none of them, or nothing else.
Result<Mesh> faced_part(const Mesh& surface, const Volume& labels, int label, int frame, const FacedLabels& faced);

}  // namespace homolog
