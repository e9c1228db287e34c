#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/measure/compare.h"
#include "core/mesh/mesh_io.h"
#include "core/model/measures/sizes.h"

namespace homolog {

// Two observers of the same cases: how well they agree.

/// Distances between the landmarks that two shapes both name, mm.
std::map<std::string, double> landmark_distances_mm(const MeshFile& a, const MeshFile& b);

/// One case as two observers have it.
struct ObservedCase {
  std::string name;
  Agreement agreement;
  double volume_a_ml = 0, volume_b_ml = 0;
  std::map<std::string, double> landmarks_mm;
  std::vector<std::string> warnings;  ///< units, axes or faces that differ; each names the case
};
/// Errors: points alone, faces that are no surface.
Result<ObservedCase> compare_observers(std::string name, const MeshFile& a, const MeshFile& b);

/// The shapes of one observer by the names of their cases.
using ObservedShapes = std::map<std::string, std::shared_ptr<const MeshFile>>;
struct ObserverRead {
  ObservedShapes shapes;
  std::vector<std::string> warnings;
};
/// Reads the shapes of a study (names as there), of a folder (every case and mesh in it, named as its file), or of one
/// file, whose name is empty, so that it is compared with one file of any name. Errors: nothing there that could be
/// read.
Result<ObserverRead> read_observer(const std::filesystem::path& path, Progress* progress = nullptr);

struct ObserverComparison {
  std::vector<ObservedCase> cases;                   ///< in the order of their names
  std::vector<std::string> only_first, only_second;  ///< cases that the other one lacks
};
/// Compares what both have, by name; cases run in parallel. Errors: no case in common, compare_observers' with the
/// case's name, cancelled.
Result<ObserverComparison> compare_observers(const ObservedShapes& first, const ObservedShapes& second,
                                             Progress* progress = nullptr);

/// CSV: a row a case with dice, distances, volumes, and the distance of every landmark.
std::string observers_table(const ObserverComparison& comparison);

}  // namespace homolog
