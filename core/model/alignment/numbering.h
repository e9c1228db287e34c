#pragma once

#include <memory>
#include <vector>

#include "core/mesh/topology.h"
#include "core/model/alignment/procrustes.h"

namespace homolog {

/// Shapes whose vertices are in another order than most others have them.
struct OtherNumbering {
  std::vector<Eigen::Index> shapes;  ///< columns, in rising order
  Eigen::Index example = 0;          ///< a shape that is numbered as most are; where no two are alike, the first
};

/// Looks for them by what lies beside what. A vertex has the same neighbours in all shapes that are in correspondence:
/// at about the same distances, as shares of the size. In another order the places of those vertices are far apart.
/// Neighbours are those of the one-ring, or of points alone the six nearest. Named are shapes in which a quarter of the
/// neighbourhoods are torn or gathered several times, so neither a model's variety nor a few swapped vertices are.
/// Empty where there are too few points to tell. Turning or mirroring a shape changes nothing. `topology`: null for
/// points alone.
OtherNumbering other_numbering(const ShapeMatrix& shapes, const std::shared_ptr<const Topology>& topology);

}  // namespace homolog
