#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/model/shape_model.h"

namespace homolog {

/// Names to write the shapes of files under: those of names_with_folders, with - for / ("pre-P1", "post-P1").
std::vector<std::string> shape_names(const std::vector<std::string>& files);
/// Names for tables: where several files' names are equal, with as many folders as tell them apart ("pre/P1",
/// "post/P1"). -2, -3, … where they lie in one folder.
std::vector<std::string> names_with_folders(const std::vector<std::string>& files);
/// The name of a shape's file without folders and extension, with the structure and the frame that it is of.
std::string shape_stem(const std::string& file);
/// Names of shapes that come one after the other: their stems, with -2, -3, … where several are equal.
class ShapeNames {
 public:
  std::string next(const std::string& file);
  /// The next name, for a file's name without folders and extension.
  std::string next_of(const std::string& stem);

 private:
  std::map<std::string, int> used_;
};

/// Writes tables into `folder` (made where absent): `mean.csv` (x, y, z in mm), `variances.csv` (every mode's λ in mm²,
/// share, cumulative share) and `scores.csv` (a row a training shape, its coefficients of all modes in mm).
/// `sizes_mm` and `groups`: of each shape, the last columns there; none where empty.
Result<void> write_model_tables(const PrincipalComponents& components, const std::vector<std::string>& names,
                                const std::filesystem::path& folder, const std::vector<double>& sizes_mm = {},
                                const std::vector<std::string>& groups = {});

/// Writes `poses.csv` into `folder` (made where absent): a row a shape and structure with its offset (mm), turn (axis
/// times angle, degrees) and scale against the structure's mean place, and whether it was completed (1) or is its own.
Result<void> write_pose_table(const StructurePoses& poses, const std::vector<StructurePart>& parts,
                              const std::vector<std::string>& names, const std::vector<CompletedStructure>& completed,
                              const std::filesystem::path& folder);

/// Writes every shape as it was aligned into `folder` (made where absent): NAME.particles, and NAME.ply where there is
/// a topology. Numbering is the files' own.
Result<void> write_aligned_shapes(const PrincipalComponents& components,
                                  const std::shared_ptr<const Topology>& topology,
                                  const std::vector<std::string>& names, const std::filesystem::path& folder);

/// Text as a field of a CSV file [RFC 4180].
std::string csv_field(const std::string& text);

}  // namespace homolog
