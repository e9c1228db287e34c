#include "app/verbs/statistics/test_cases.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "app/verbs/statistics/case_rows.h"
#include "core/base/text/nearest_names.h"
#include "core/base/text/text_table.h"
#include "core/model/alignment/self_mirror.h"
#include "core/model/files/model_files.h"
#include "core/model/joint_models/joint_set.h"
#include "core/model/joint_models/structure_files.h"
#include "core/model/shapes/shape_files.h"
#include "core/model/shapes/study.h"

namespace homolog {

namespace fs = std::filesystem;

namespace {

/// What is known of a study's case: the columns of the table that `study make` was given, and others that its file has.
std::map<std::string, std::string> known_of(const StudyCase& one) {
  std::map<std::string, std::string> known;
  const auto take = [&](const std::string& key, const auto& value) {
    if (!value.is_structured() && !value.is_null())
      known.emplace(key, value.is_string() ? value.template get<std::string>() : value.dump());
  };
  for (const auto& [key, value] : one.covariates.items()) take(key, value);
  take("label", one.label);
  for (const auto& [key, value] : one.other.items()) take(key, value);
  return known;
}

/// What a study knows of its cases: their group and the columns that its table had. Of no study nothing.
CovariateTable covariates_of(const std::map<std::string, StudyCase>& cases, const std::string& source) {
  CovariateTable table{source, {}, {}, {}};
  if (cases.empty()) return table;
  table.columns = {"group"};
  const auto all_known_of = [](const StudyCase& one) {
    auto known = known_of(one);
    known.emplace("case", one.name);  // pairs the frames of a cine
    return known;
  };
  for (const auto& [study_key, one] : cases)
    for (const auto& [key, value] : all_known_of(one))
      if (!table.column(key)) table.columns.push_back(key);
  for (const auto& [study_key, one] : cases) {
    table.cases.push_back(one.name);
    std::vector<std::string> row{one.group};
    auto known = all_known_of(one);
    for (std::size_t k = 1; k < table.columns.size(); ++k) row.push_back(known[table.columns[k]]);
    table.cells.push_back(std::move(row));
  }
  return table;
}

/// The columns that the formula and the pairs need, each once.
Result<std::vector<std::size_t>> needed_columns(const TestCasesAsked& asked, const CovariateTable& table) {
  std::vector<Variable> variables{asked.formula.response};
  for (const FormulaTerm& term : asked.formula.terms) variables.insert(variables.end(), term.begin(), term.end());
  if (!asked.paired.empty()) variables.push_back({Variable::By::factor, asked.paired});
  std::set<std::size_t> columns;
  for (const Variable& one : variables) {
    const auto column = table.column(one.name);
    if (column && one.name != "shape") columns.insert(*column);
    if (column || one.name == "shape" || one.name == "size") continue;
    if (asked.object_symmetry && (one.name == mirrored_column || one.name == whose_column)) continue;
    if (table.columns.empty())
      return fail("--covariates", "is needed for " + one.name + ": the shapes are of no study that knows it");
    if (one.name == table.first_as_names)
      return fail(one.name, "was taken as the names of the cases, since no column of " + table.source +
                                " is called name, case or id; call the column of the names so");
    std::vector<std::string> words = table.columns;
    words.insert(words.end(), {"shape", "size"});
    if (asked.object_symmetry) words.emplace_back(mirrored_column);
    return fail(one.name, "is no column of " + table.source + "; there are " + listed(words, " and ") +
                              ". Did you mean " + listed(nearest_names(one.name, words, 1), " or ") + "?");
  }
  return std::vector<std::size_t>(columns.begin(), columns.end());
}

/// Groups that numbers name are told apart by their value.
void write_group_numbers_alike(const TestCasesAsked& asked, CovariateTable& table) {
  for (const FormulaTerm& term : asked.formula.terms)
    for (const Variable& one : term)
      if (const auto column = table.column(one.name); column && one.by == Variable::By::factor)
        write_numbers_alike(table, *column);
}

/// Whether a row is of a study's case that is of another group.
bool is_of_other_group(const std::map<std::string, StudyCase>& studies, const std::string& row,
                       const std::string& group) {
  return !group.empty() && std::ranges::any_of(studies, [&](const auto& one) {
    return one.second.name == row && one.second.group != group;
  });
}

struct Partner {
  Eigen::Index shape;
  std::size_t row;
};

std::string first_words(const std::vector<std::string>& names) {
  const std::vector<std::string> first(names.begin(), names.begin() + std::min<std::ptrdiff_t>(3, std::ssize(names)));
  return listed(first, ", ") + (names.size() > 3 ? ", …" : "");
}

/// The shapes of one structure, or of several whose places count among each other too.
Result<TrainingSetRead> read_shapes_asked(const TrainingVerb& shapes, Progress& progress) {
  if (shapes.structures.empty()) return read_training_set(shapes.files, shapes.reading, &progress);
  const auto cases = structure_files(shapes.files, shapes.structures, ShapeWorksFrame::local, 1);
  if (!cases) return fail(cases.error());
  auto joint = read_joint_set(
      *cases, shapes.structures,
      {.without_doubtful = shapes.reading.without_doubtful, .vertex_doubts = shapes.reading.vertex_doubts}, &progress);
  if (!joint) return fail(joint.error());
  return std::move(joint->read);
}

/// Takes the direction from one shape to the other out of aligned shapes: what they differ along it is nobody's.
Result<void> take_direction_out(const std::vector<fs::path>& two, const TrainingVerb& asked, ShapeMatrix& shapes) {
  const Eigen::VectorXd mean = shapes.rowwise().mean();
  ShapeMatrix ends(shapes.rows(), 2);
  for (Eigen::Index k = 0; k < 2; ++k) {
    const fs::path& file = two[k];
    const auto read = read_shape(ShapeSource{file, {}});
    if (!read) return fail(read.error());
    if ((*read)->points.size() != shapes.rows())
      return fail(file.string(), "has " + std::to_string((*read)->points.rows()) + " vertices where the shapes have " +
                                     std::to_string(shapes.rows() / 3) + "; give two shapes of the same template");
    Points points = (*read)->points;
    if (asked.alignment() != Alignment::none && looks_mirrored(points_of(mean), points)) {
      if (!asked.reading.flip_mirrored)
        return fail(file.string(),
                    "is a mirror image of the shapes (left and right exchanged), whose direction is another; use "
                    "--flip-mirrored");
      points.col(0) *= -1;
    }
    const Points aligned = aligned_to(points, points_of(mean), asked.alignment());
    ends.col(k) = Eigen::Map<const Eigen::VectorXd>(aligned.data(), aligned.size());
  }
  const Eigen::VectorXd along = ends.col(1) - ends.col(0);
  if (!(along.norm() > 1e-6 * mean.norm()))
    return fail(two.back().string(), "is the same shape as " + two.front().string() + ", which gives no direction");
  const Eigen::VectorXd direction = along.normalized();
  const Eigen::RowVectorXd amounts = direction.transpose() * (shapes.colwise() - mean);
  shapes -= direction * amounts;
  return {};
}

/// The rows of the shapes, then of those that were left out, so that no other shape takes theirs.
Result<std::vector<std::optional<std::size_t>>> rows_of_all(const TestCasesAsked& asked, const TrainingSetRead& read,
                                                            const std::map<std::string, StudyCase>& studies,
                                                            const TestCases& cases) {
  std::vector<ShapeOfRow> shapes;
  for (std::size_t k = 0; k < read.set.names.size(); ++k) shapes.push_back({read.set.names[k], read.study_keys[k]});
  for (const DoubtfulShape& one : cases.left_out) shapes.push_back({one.name, one.study_keys});
  return rows_of_shapes(cases.table, studies, shapes, asked.shapes.structures.empty());
}

/// Shapes with their rows; what has no partner goes into `left_out`. `names`: of the shapes.
Result<std::vector<Partner>> partners(const TestCasesAsked& asked, const TrainingSetRead& read,
                                      const std::vector<std::string>& names,
                                      const std::map<std::string, StudyCase>& studies, TestCases& cases) {
  const TrainingSet& set = read.set;
  const auto rows = rows_of_all(asked, read, studies, cases);
  if (!rows) return fail(rows.error());
  std::vector<Partner> found;
  std::map<std::size_t, std::string> taken;
  std::set<std::size_t> known_to_lack;  // rows of shapes that were left out
  for (std::size_t k = names.size(); k < rows->size(); ++k)
    if ((*rows)[k]) known_to_lack.insert(*(*rows)[k]);
  const auto is_of_study = [&](const std::vector<std::string>& keys) {
    return std::ranges::any_of(keys, [&](const std::string& key) { return studies.contains(key); });
  };
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto row = (*rows)[k];
    if (!row) {
      cases.left_out.push_back({names[k], "has no row in " + cases.table.source});
      continue;
    }
    const auto [other, is_new] = taken.emplace(*row, set.names[k]);
    const bool are_frames = asked.shapes.reading.all_frames && is_of_study(read.study_keys[k]);
    if (!is_new && !are_frames)
      return fail(set.names[k], "has the name of " + other->second + ", so one row of the table would count twice");
    found.push_back({static_cast<Eigen::Index>(k), *row});
  }
  if (found.empty())
    return fail(cases.table.source, "names none of the shapes; it has " + first_words(cases.table.cases) +
                                        " where the shapes are " + first_words(names));
  for (std::size_t row = 0; row < cases.table.cases.size(); ++row)
    if (!taken.contains(row) && !known_to_lack.contains(row) &&
        !is_of_other_group(studies, cases.table.cases[row], asked.shapes.reading.group))
      cases.left_out.push_back({cases.table.cases[row], "is a row without a shape"});
  return found;
}

/// Every shape with a row of its own.
std::vector<Partner> rows_of_their_own(const std::vector<std::string>& names, TestCases& cases) {
  std::vector<Partner> all;
  for (std::size_t k = 0; k < names.size(); ++k) all.push_back({static_cast<Eigen::Index>(k), k});
  cases.table.cases = names;
  cases.table.cells.resize(names.size());
  return all;
}

/// Takes out cases that lack a value, and those of pairs whose partner is not there.
void leave_out_incomplete(std::vector<Partner>& partners, const std::vector<std::size_t>& columns,
                          const std::string& paired, TestCases& cases) {
  const auto leave_out_if = [&](const auto& reason) {
    std::erase_if(partners, [&](const Partner& one) {
      const std::string why = reason(cases.table.cells[one.row]);
      if (!why.empty()) cases.left_out.push_back({cases.table.cases[one.row], why});
      return !why.empty();
    });
  };
  leave_out_if([&](const std::vector<std::string>& row) {
    for (const std::size_t column : columns)
      if (is_missing(row[column])) return "has no value of " + cases.table.columns[column];
    return std::string();
  });
  if (paired.empty()) return;
  const std::size_t column = *cases.table.column(paired);
  std::map<std::string, int> sizes;
  for (const Partner& one : partners) ++sizes[cases.table.cells[one.row][column]];
  leave_out_if([&](const std::vector<std::string>& row) {
    return sizes[row[column]] > 1 ? std::string() : "is the only case of " + paired + " " + row[column];
  });
}

/// Puts each case's mirror image behind the cases, and says so in the table. Errors: shapes that are not symmetric, a
/// column of that name.
Result<void> add_mirror_images(const TestCasesAsked& asked, TestCases& cases) {
  if (cases.table.column(mirrored_column))
    return fail(cases.table.source, std::string("has a column ") + mirrored_column +
                                        ", which --object-symmetry makes; give it another name");
  if (!cases.topology) return fail("--object-symmetry", "needs faces, and the shapes are points alone; give meshes");
  ShapeMatrix aligned = cases.shapes;
  align(aligned, asked.shapes.alignment());
  const Eigen::VectorXd mean = aligned.rowwise().mean();
  const auto mirror = self_mirror({cases.topology, points_of(mean)});
  if (!mirror) return fail(asked.shapes.files.front().string(), mirror.error().what);
  cases.symmetry_off_mm = mirror->off_mm;
  const Eigen::Index count = cases.shapes.cols();
  const bool has_whose = cases.table.column(whose_column).has_value();
  CovariateTable table = cases.table;
  table.cases.clear();
  table.cells.clear();
  table.columns.emplace_back(mirrored_column);
  if (!has_whose) table.columns.emplace_back(whose_column);
  cases.shapes.conservativeResize(Eigen::NoChange, 2 * count);
  cases.sizes_mm.conservativeResize(2 * count);
  for (Eigen::Index i = 0; i < 2 * count; ++i) {
    const bool is_image = i >= count;
    const Eigen::Index of = is_image ? i - count : i;
    const std::string name = cases.names[of];
    table.cases.push_back(is_image ? name + " mirrored" : name);
    table.cells.push_back(cases.table.cells[cases.rows[of]]);
    table.cells.back().emplace_back(is_image ? "yes" : "no");
    if (!has_whose) table.cells.back().push_back(name);
    if (!is_image) continue;
    const Points image = mirrored_in_itself(*mirror, points_of(cases.shapes, of));
    cases.shapes.col(i) = Eigen::Map<const Eigen::VectorXd>(image.data(), image.size());
    cases.sizes_mm[i] = cases.sizes_mm[of];
  }
  cases.names = table.cases;
  cases.rows.resize(table.cases.size());
  std::iota(cases.rows.begin(), cases.rows.end(), std::size_t{0});
  cases.table = std::move(table);
  return {};
}

/// How many times as large as they were the aligned shapes are.
Eigen::VectorXd scales_of(const TestCases& cases, Alignment alignment) {
  Eigen::VectorXd scales = Eigen::VectorXd::Ones(cases.sizes_mm.size());
  if (alignment != Alignment::similarity) return scales;
  for (Eigen::Index i = 0; i < scales.size(); ++i)
    if (cases.sizes_mm[i] > 0) scales[i] = centroid_size_mm(points_of(cases.shapes, i)) / cases.sizes_mm[i];
  return scales;
}

Result<void> take_shapes(const TestCasesAsked& asked, const TrainingSetRead& read,
                         const std::vector<std::string>& names, const std::vector<Partner>& partners,
                         TestCases& cases) {
  const TrainingSet& set = read.set;
  std::map<std::size_t, int> times;  // by row
  for (const Partner& one : partners) ++times[one.row];
  const auto count = static_cast<Eigen::Index>(partners.size());
  cases.shapes.resize(set.shapes.rows(), count);
  cases.sizes_mm.resize(count);
  cases.topology = set.topology;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Partner& one = partners[i];
    // Of several frames of a case each has its own name.
    cases.names.push_back(times[one.row] == 1 ? cases.table.cases[one.row] : names[one.shape]);
    cases.rows.push_back(one.row);
    cases.shapes.col(i) = set.shapes.col(one.shape);
    cases.sizes_mm[i] = centroid_size_mm(points_of(cases.shapes, i));
  }
  if (asked.object_symmetry)
    if (auto added = add_mirror_images(asked, cases); !added) return added;
  align(cases.shapes, asked.shapes.alignment());
  const Eigen::VectorXd scales = scales_of(cases, asked.shapes.alignment());
  if (!asked.direction.empty())
    if (auto out = take_direction_out(asked.direction, asked.shapes, cases.shapes); !out) return out;
  if (!asked.shapes.reading.vertex_doubts) return {};
  const Eigen::Index vertices = cases.shapes.rows() / 3;
  VertexScalars squares = VertexScalars::Zero(vertices);
  double known = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Partner& one = partners[i];
    const auto doubt = read.vertex_doubts.find(set.names[one.shape]);
    const bool is_known = doubt != read.vertex_doubts.end() && doubt->second.size() == vertices;
    const VertexScalars scaled = is_known ? VertexScalars(scales[i] * doubt->second) : VertexScalars();
    cases.doubt_mm.push_back(is_known ? std::sqrt(scaled.cwiseAbs2().mean())
                                      : std::numeric_limits<double>::quiet_NaN());
    if (is_known) squares += scaled.cwiseAbs2();
    known += is_known ? 1 : 0;
  }
  if (known > 0) cases.vertex_doubt_mm = (squares / known).cwiseSqrt();
  if (asked.object_symmetry) {
    const auto own = cases.doubt_mm;
    cases.doubt_mm.insert(cases.doubt_mm.end(), own.begin(), own.end());
  }
  return {};
}

}  // namespace

Result<std::map<std::string, StudyCase>> cases_of_studies(const std::vector<fs::path>& files) {
  std::map<std::string, StudyCase> cases;
  for (const fs::path& file : files) {
    if (!is_study_file(file)) continue;
    auto read = read_study(file);
    if (!read) return fail(read.error());
    for (StudyCase& one : read->study.cases) {
      const std::string key = source_of(one).study_key();
      cases.emplace(key, std::move(one));
    }
  }
  return cases;
}

Result<TestCases> read_test_cases(const TestCasesAsked& asked, Progress& progress) {
  const auto studies = cases_of_studies(asked.shapes.files);
  if (!studies) return fail(studies.error());
  auto table = asked.covariates.empty()
                   ? Result<CovariateTable>(covariates_of(*studies, asked.shapes.files.front().string()))
                   : read_covariates(asked.covariates);
  if (!table) return fail(table.error());
  TestCases cases;
  cases.table = std::move(*table);
  const auto columns = needed_columns(asked, cases.table);
  if (!columns) return fail(columns.error());
  write_group_numbers_alike(asked, cases.table);
  auto read = read_shapes_asked(asked.shapes, progress);
  if (!read) return fail(read.error());
  const auto names = asked.shapes.structures.empty() ? names_with_folders(read->set.names) : read->set.names;
  cases.warnings = std::move(read->warnings);
  cases.warnings.insert(cases.warnings.end(), cases.table.warnings.begin(), cases.table.warnings.end());
  cases.left_out = std::move(read->left_out);
  const bool sizes_are_enough = cases.table.columns.empty() && cases.table.cases.empty();
  auto found = sizes_are_enough ? Result<std::vector<Partner>>(rows_of_their_own(names, cases))
                                : partners(asked, *read, names, *studies, cases);
  if (!found) return fail(found.error());
  // What object symmetry pairs is made of each case alone.
  leave_out_incomplete(*found, *columns, asked.object_symmetry ? std::string() : asked.paired, cases);
  std::set<std::size_t> rows;
  const bool has_frames = std::ranges::any_of(*found, [&](const Partner& one) { return !rows.insert(one.row).second; });
  if (has_frames && asked.paired.empty())
    cases.warnings.push_back(cases.table.source +
                             ": gives several frames of a case, which count as if they were cases; compare them within "
                             "each by --paired case");
  if (found->size() < 2) {
    std::string why;
    if (!cases.left_out.empty()) why = " (" + cases.left_out.back().name + " " + cases.left_out.back().reason + ")";
    return fail(cases.table.source, "leaves " + std::string(found->empty() ? "no case" : "one case") + " to be tested" +
                                        why + "; complete it, or give more shapes");
  }
  if (auto taken = take_shapes(asked, *read, names, *found, cases); !taken) return fail(taken.error());
  return cases;
}

}  // namespace homolog
