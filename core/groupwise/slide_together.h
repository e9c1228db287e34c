#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/mesh/topology.h"
#include "core/model/alignment/procrustes.h"

namespace homolog {

/// A set as it was before a round of sliding.
struct GroupwiseRound {
  double bits = 0;           ///< description length of positions and features together
  double position_bits = 0;  ///< description length of positions alone
  double variance_mm2 = 0;   ///< variance of the aligned shapes over all modes, a vertex
  double way_mm = 0;         ///< root mean square of what vertices slid in the round that follows; 0 in the last
};

struct GroupwiseOptions {
  Alignment alignment = Alignment::similarity;
  int rounds = 20;
  std::vector<VertexScalars> held;  ///< n values of each shape: 0 free, others stay exactly; empty: all free
  Progress* progress = nullptr;
  /// Called after each round, on the thread that slides.
  std::function<void(const std::vector<GroupwiseRound>& rounds)> show;
};

struct GroupwiseResult {
  ShapeMatrix shapes;                    ///< 3n×M, each in the frame that it was given in, mm
  std::vector<GroupwiseRound> rounds;    ///< the first: as given; the last: the result
  std::vector<double> largest_slide_mm;  ///< the largest slide of each shape's vertices
};

/// Groupwise refinement: vertices slide along their own surfaces so that the set gets shorter to describe. Described
/// are what the surface looks like around each vertex [surface_features.h] and, less heavily, positions: positions
/// alone would draw each shape to the mean, which makes a compact model of worse correspondence
/// (docs/correspondence.md). Each round moves every shape towards what the others' model expects [description.h], the
/// precision rising from round to round. All shapes must share the topology. The bits of the result do not depend on
/// the number of threads. Errors: fewer than two shapes; shapes without extent; cancelled.
Result<GroupwiseResult> slide_together(const std::shared_ptr<const Topology>& topology, const ShapeMatrix& shapes,
                                       const GroupwiseOptions& options = {});

}  // namespace homolog
