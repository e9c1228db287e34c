#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/mesh/topology.h"
#include "core/model/procrustes.h"

namespace homolog {

/// Shapes in correspondence, where their files have them.
struct TrainingSet {
  std::vector<std::string> names;            ///< path of each shape
  std::shared_ptr<const Topology> topology;  ///< null where every file is `.particles`
  ShapeMatrix shapes;                        ///< 3n×M, mm
};

struct TrainingSetRead {
  TrainingSet set;
  std::vector<std::string> warnings;  ///< each names its file: what was left out, and what looks wrong (see oddities)
};

/// Reads meshes (PLY, VTK, VTP, OBJ) and `.particles` into one training set. A file that cannot be read (absent,
/// damaged, a NaN vertex) is left out with a warning. Errors: a mesh with another vertex count or other faces than most
/// of the rest have (named, with both counts), an STL file, fewer than two shapes left, shapes that are all equal,
/// cancelled.
Result<TrainingSetRead> read_training_set(const std::vector<std::filesystem::path>& files,
                                          Progress* progress = nullptr);

/// What looks wrong in a set that can be computed with, a sentence each: shapes that are mirror images of most others,
/// sizes 10, 100 or 1000 times those of most others, shapes given twice.
std::vector<std::string> oddities(const TrainingSet& set);

}  // namespace homolog
