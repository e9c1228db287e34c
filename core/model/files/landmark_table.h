#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/mesh/mesh_io.h"

namespace homolog {

// Landmarks of many shapes in one file, for programs of geometric morphometrics.

/// One shape's landmarks.
struct Specimen {
  std::string name;
  std::vector<Landmark> landmarks;  ///< LPS mm
};

/// Every vertex of a shape as a landmark, named by its number from 0.
std::vector<Landmark> vertices_as_landmarks(const Points& points);

struct LandmarkTable {
  std::string text;
  std::vector<std::string> landmarks;  ///< names, in the order of their columns
  std::vector<std::string> lacking;    ///< specimens that lack some, whose coordinates are NA there
};
/// TPS: for each specimen `LM3=` and the number of landmarks, x y z of each, `ID=` and its name. geomorph reads it:
/// readland.tps(file, specID = "ID").
LandmarkTable tps_of(const std::vector<Specimen>& specimens);
/// CSV: a row a specimen, its name and x, y, z of each landmark, below a row of column names. MorphoJ reads it as
/// "row/column" with three dimensions, R by read.csv.
LandmarkTable csv_of(const std::vector<Specimen>& specimens);

/// One of the two, by the ending of the name; whole or not at all. Errors: another ending, no landmarks.
Result<LandmarkTable> write_landmark_table(const std::vector<Specimen>& specimens, const std::filesystem::path& path);

}  // namespace homolog
