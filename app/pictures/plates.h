#pragma once

#include <string>
#include <vector>

#include "app/pictures/pictures.h"
#include "core/base/text/text_table.h"
#include "core/model/measures/score.h"

namespace homolog {

/// A mesh coloured by a value of each vertex (NaN: not known), from the side of `options.from` and from behind, with a
/// colour bar. `range` {low, high} of the colours, or empty. Errors: montage's.
Result<Page> map_page(const Mesh& mesh, const VertexScalars& values, const std::string& property,
                      const std::vector<double>& range, const MontageOptions& options);

/// The mean of a group of shapes.
struct GroupMean {
  std::string name;
  Eigen::Index shapes = 0;
  Points mean;  ///< n×3, mm, aligned as the others
};
/// The first group against each other: both means, and how far the other's surface lies outside of the first's, from
/// both sides. Two groups or more. Errors: montage's.
Result<Page> groups_page(const std::vector<GroupMean>& groups, const std::shared_ptr<const Topology>& topology,
                         const std::vector<double>& range, const MontageOptions& options);

/// A subject against a model: the mean, the subject, its z on the surface from both sides, and its coordinates among
/// those of the training shapes. Errors: montage's; a model without faces or without coordinates.
Result<Page> score_page(const ShapeModel& model, const ShapeScore& score, const std::string& name,
                        const std::vector<double>& range, const MontageOptions& options);

/// The variances of a model, and the training shapes in its first two modes. Errors: a model without coordinates.
Result<Page> model_plots(const ShapeModel& model, double width_mm);
/// Compactness, generalisation and specificity with their standard errors, of a table that `evaluate --csv` wrote.
/// Errors: a table without one of the columns, a cell that is no number.
Result<Page> measure_plots(const TextTable& table, double width_mm);

/// Which columns of a table are shown.
struct TablePlot {
  std::string x, y;  ///< x: numbers, or words that name groups
  std::string by;    ///< words, each a colour; empty: one colour
};
/// The rows of a table as dots. If x names groups, the dots of a group stand side by side, with their mean and its
/// standard error. Rows without one of the values are left out. Errors: a column that is not there, y that is no
/// number, no rows, more groups than colours. Long names of groups are parted into lines, or shortened.
Result<Page> table_plot(const TextTable& table, const TablePlot& shown, double width_mm);
/// How many rows a plot leaves out.
std::size_t rows_without_values(const TextTable& table, const TablePlot& shown);

}  // namespace homolog
