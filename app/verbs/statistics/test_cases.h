#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "app/verbs/model/training.h"
#include "core/model/shapes/study.h"
#include "core/statistics/covariates.h"
#include "core/statistics/formula.h"

namespace homolog {

/// The arguments of `test` on its cases.
struct TestCasesAsked {
  TrainingVerb shapes;
  std::filesystem::path covariates;  ///< empty: a study's own
  Formula formula;
  std::string paired;                            ///< the column of the subjects; empty: unpaired
  std::vector<std::filesystem::path> direction;  ///< the way from one shape to another: is taken out; empty: none
  bool object_symmetry = false;  ///< each case counts twice: as it is, and as its mirror image in its own numbering
};

/// The columns that object symmetry adds: whether a case is its own mirror image ("no", "yes"), and whose.
inline constexpr const char* mirrored_column = "mirrored";
inline constexpr const char* whose_column = "case";

/// Shapes with what is known of them, in the order in which the shapes were given.
struct TestCases {
  std::vector<std::string> names;
  ShapeMatrix shapes;                        ///< aligned, mm
  std::shared_ptr<const Topology> topology;  ///< null: of points alone
  Eigen::VectorXd sizes_mm;                  ///< centroid sizes before they were aligned
  CovariateTable table;
  std::vector<std::size_t> rows;  ///< the table's row of each case
  std::vector<double> doubt_mm;   ///< root mean square over the aligned vertices; NaN: not known; empty: nobody asked
  VertexScalars vertex_doubt_mm;  ///< root mean square over the cases whose doubt is known; empty: of none
  std::vector<DoubtfulShape> left_out;  ///< shapes and rows without a partner or a value, with the reason
  std::vector<std::string> warnings;
  double symmetry_off_mm = 0;  ///< object symmetry: how far the mean's mirror image lies off it, root mean square
};

/// The cases of the studies among the files, by their keys [ShapeSource::study_key]. Errors: read_study's.
Result<std::map<std::string, StudyCase>> cases_of_studies(const std::vector<std::filesystem::path>& files);

/// Reads table and shapes, brings them together by their names, leaves out what lacks a partner or a value that the
/// formula needs, and aligns the rest. A direction that is asked for is taken out of the aligned shapes. Errors: those
/// of read_covariates and read_training_set; a word of the formula that is no column; no names in common; a row
/// that may be of several shapes; fewer than two cases left; object symmetry of shapes that have none.
Result<TestCases> read_test_cases(const TestCasesAsked& asked, Progress& progress);

}  // namespace homolog
