#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/model/shapes/study.h"
#include "core/statistics/covariates.h"

namespace homolog {

/// A shape that looks for its row.
struct ShapeOfRow {
  std::string name;                     ///< as TrainingSet names it
  std::vector<std::string> study_keys;  ///< keys of the study's cases that it is of
};

/// The row of each shape; none: it has none. A study's case has the row of its name there. All else goes by file names
/// without their endings. A folder in a row's name has to be the shape's too. If no row names a folder that a shape
/// lies in, the tables' folders are others than the shapes', and the file name alone counts. `are_files`: names of
/// shapes are paths, else names of cases. Errors: a row that may be of several shapes, a shape that may have several
/// rows.
Result<std::vector<std::optional<std::size_t>>> rows_of_shapes(const CovariateTable& table,
                                                               const std::map<std::string, StudyCase>& studies,
                                                               const std::vector<ShapeOfRow>& shapes, bool are_files);

}  // namespace homolog
