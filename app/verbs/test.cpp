#include <cmath>
#include <filesystem>
#include <map>
#include <optional>

#include "app/verbs/test_cases.h"
#include "core/base/files.h"
#include "core/mesh/formats/formats.h"
#include "core/model/groups.h"
#include "core/model/model_files.h"
#include "core/statistics/design.h"
#include "core/statistics/landmark_test.h"
#include "core/statistics/linear_test.h"
#include "core/statistics/parallel_analysis.h"

// The verb `test`: what shapes have to do with what is known of their cases.

namespace homolog {

namespace fs = std::filesystem;

namespace {

struct TestOptions {
  TestCasesAsked asked;
  std::string formula;
  Eigen::Index permutations = 999, modes = 0;
  std::uint64_t seed = 1;
  fs::path permutation_file, tables;
  std::vector<Eigen::Index> at;  ///< vertices whose places are written
};

/// What is computed with.
struct TestJob {
  const TestOptions& options;
  TestCases cases;
  Design design{};
  Eigen::MatrixXd responses{};  ///< a case a column
  Eigen::VectorXd root_weights{};
  Permutations permutations{};
  Eigen::Index modes = 0;          ///< where the shape is what explains
  std::vector<fs::path> tables{};  ///< those that were written

  bool of_shape() const { return options.asked.formula.response.name == "shape"; }
  double vertices() const { return static_cast<double>(cases.shapes.rows()) / 3; }
};

std::string case_named(const TestCases& cases, Eigen::Index k) {
  return cases.names[static_cast<std::size_t>(k)];
}

/// Sizes or a column as numbers.
Result<Eigen::VectorXd> numbers_asked(const TestCases& cases, const Variable& variable) {
  if (cases.table.column(variable.name)) return numbers_of(cases.table, cases.rows, variable);
  return transformed(variable, cases.sizes_mm, [&](Eigen::Index k) { return case_named(cases, k); });
}

/// The first modes of the shapes, as numbers that explain.
Result<CodedVariable> coded_modes(TestJob& job, Progress& progress) {
  const PrincipalComponents components = principal_components(job.cases.shapes);
  job.modes =
      job.options.modes > 0 ? job.options.modes : modes_above_chance(job.cases.shapes, job.options.seed, &progress);
  if (job.modes == 0) return fail("shape", "has no mode that holds more than chance; ask for some with --modes");
  if (job.modes > components.scatter.size())
    return fail("--modes", "asks for " + std::to_string(job.modes) + " modes, and the shapes have " +
                               std::to_string(components.scatter.size()));
  const Eigen::MatrixXd scores = components.scores().topRows(job.modes).transpose();
  const Eigen::VectorXd deviations = components.variances().head(job.modes).cwiseSqrt();
  return CodedVariable{scores * deviations.cwiseInverse().asDiagonal(), {}};
}

Result<void> put_design(TestJob& job, Progress& progress) {
  const TestCasesAsked& asked = job.options.asked;
  std::vector<FormulaTerm> terms = asked.formula.terms;
  if (!asked.paired.empty()) terms.insert(terms.begin(), {{Variable::By::factor, asked.paired}});
  const auto code = [&](const Variable& variable) -> Result<CodedVariable> {
    if (variable.name == "shape") return coded_modes(job, progress);
    if (job.cases.table.column(variable.name)) return coded_column(job.cases.table, job.cases.rows, variable);
    const auto numbers = numbers_asked(job.cases, variable);
    if (!numbers) return fail(numbers.error());
    return coded_numbers(variable.text(), *numbers);
  };
  auto design = make_design(terms, asked.paired.empty() ? 0 : 1, code);
  if (!design) return fail(design.error());
  job.design = std::move(*design);
  return {};
}

Result<void> put_responses(TestJob& job) {
  const Variable& response = job.options.asked.formula.response;
  if (job.of_shape()) {
    job.responses = job.cases.shapes;
    return {};
  }
  const auto numbers = numbers_asked(job.cases, response);
  if (!numbers) return fail(numbers.error());
  if (const auto varied = coded_numbers(response.text(), *numbers); !varied) return fail(varied.error());
  job.responses = numbers->transpose();
  return {};
}

/// w = s² / (s² + d²): d is a case's doubt, s² what the model leaves of a vertex without weights [docs/statistics.md].
Result<void> put_weights(TestJob& job) {
  job.root_weights.setOnes(job.design.cases());
  const std::vector<double>& doubts = job.cases.doubt_mm;
  if (doubts.empty()) return {};
  std::size_t unknown = 0;
  for (const double doubt : doubts) unknown += std::isnan(doubt) ? 1 : 0;
  if (unknown == doubts.size())
    return fail("--by-doubt", "has no effect: none of the shapes has a doubt, which fit and study write into them");
  if (unknown > 0)
    job.cases.warnings.push_back(std::to_string(unknown) + " of the shapes have no doubt and count in full");
  const Permutations none(0, job.design.cases());
  const LinearTest plain = test_terms(job.design, job.cases.shapes, job.root_weights, none);
  const double left = plain.residual_ss / (static_cast<double>(plain.residual_df) * job.vertices());
  for (std::size_t k = 0; k < doubts.size(); ++k)
    if (!std::isnan(doubts[k]))
      job.root_weights[static_cast<Eigen::Index>(k)] = std::sqrt(left / (left + doubts[k] * doubts[k]));
  return {};
}

Result<void> put_permutations(TestJob& job) {
  std::vector<int> blocks(static_cast<std::size_t>(job.design.cases()), 0);
  const std::string& paired = job.options.asked.paired;
  if (!paired.empty()) {
    std::map<std::string, int> numbers;
    const std::size_t column = *job.cases.table.column(paired);
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      const std::string& subject = job.cases.table.cells[job.cases.rows[k]][column];
      blocks[k] = numbers.emplace(subject, static_cast<int>(numbers.size())).first->second;
    }
  }
  if (job.options.permutation_file.empty()) {
    job.permutations = random_permutations(blocks, job.options.permutations, job.options.seed);
    return {};
  }
  auto read = read_permutations(job.options.permutation_file, job.design.cases());
  if (!read) return fail(read.error());
  job.permutations = std::move(*read);
  for (Eigen::Index row = 0; row < job.permutations.rows(); ++row)
    for (std::size_t k = 0; k < blocks.size(); ++k)
      if (const int other = job.permutations(row, static_cast<Eigen::Index>(k));
          blocks[k] != blocks[static_cast<std::size_t>(other)])
        return fail(job.options.permutation_file.string(), "line " + std::to_string(row + 1) +
                                                               " moves cases from one " + paired +
                                                               " to another; pairs have to stay together");
  return {};
}

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.12g", value);
  return text;
}

/// The rows of one term, a vertex each.
std::string landmark_rows(const std::string& term, const LandmarkTest& test, const VertexScalars& outward) {
  std::string rows;
  for (Eigen::Index v = 0; v < test.p.size(); ++v) {
    rows += csv_field(term) + ',' + std::to_string(v) + ',' + number(test.p[v]) + ',' + number(test.q[v]) + ',' +
            number(test.effect[v]) + ',' + (outward.size() > 0 ? number(outward[v]) : "") + '\n';
  }
  return rows;
}

/// Where no q is small since p cannot be: what would help. Empty: that is not so.
std::string too_few_permutations(const DesignTerm& term, const LandmarkTest& test, Eigen::Index permutations) {
  const double least = 1 / static_cast<double>(permutations + 1);
  if (test.q.minCoeff() <= 0.05 || test.p.minCoeff() > least) return {};
  const double vertices = static_cast<double>(test.p.size());
  return term.name + ": no vertex has a q up to 0.05, and none can with " + std::to_string(permutations) +
         " permutations unless " + std::to_string(static_cast<int>(std::ceil(vertices * least / 0.05))) +
         " vertices have the least p that these allow; ask for more with --permutations";
}

Result<void> write_table(TestJob& job, const fs::path& file, const std::string& table) {
  job.tables.push_back(file);
  return write_whole_file(file, table);
}

Result<void> write_landmarks(TestJob& job, const fs::path& file, Progress& progress) {
  std::string table = "term,vertex,p,q,effect_mm,outward_mm\n";
  const Eigen::VectorXd mean = job.cases.shapes.rowwise().mean();
  const double terms = static_cast<double>(job.design.terms.size());
  for (std::size_t t = 0; t < job.design.terms.size(); ++t) {
    if (!job.design.terms[t].tested) continue;
    progress.part(0.4 + 0.6 * static_cast<double>(t) / terms, 0.4 + 0.6 * static_cast<double>(t + 1) / terms);
    const LandmarkTest test =
        test_landmarks(job.design, t, job.responses, job.root_weights, job.permutations, &progress);
    if (progress.cancelled()) return fail("", "cancelled");
    if (std::string why = too_few_permutations(job.design.terms[t], test, job.permutations.rows()); !why.empty())
      job.cases.warnings.push_back(std::move(why));
    VertexScalars outward;
    if (test.offset.size() > 0 && job.cases.topology)
      outward = outward_mm(Mesh{job.cases.topology, points_of(mean)}, test.offset);
    table += landmark_rows(job.design.terms[t].name, test, outward);
  }
  return write_table(job, file, table);
}

Result<void> write_cases(TestJob& job, const fs::path& file) {
  std::string table = "case,size_mm,weight\n";
  for (Eigen::Index k = 0; k < job.design.cases(); ++k)
    table += csv_field(case_named(job.cases, k)) + ',' + number(job.cases.sizes_mm[k]) + ',' +
             number(job.root_weights[k] * job.root_weights[k]) + '\n';
  return write_table(job, file, table);
}

/// Where each case has a vertex, aligned, and how far outside of the mean shape.
Result<void> write_places(TestJob& job, Eigen::Index vertex, const fs::path& file) {
  const ShapeMatrix& shapes = job.cases.shapes;
  const Eigen::VectorXd mean = shapes.rowwise().mean();
  std::string table = "case,x_mm,y_mm,z_mm,outward_mm\n";
  for (Eigen::Index k = 0; k < shapes.cols(); ++k) {
    table += csv_field(case_named(job.cases, k));
    for (Eigen::Index axis = 0; axis < 3; ++axis) table += ',' + number(shapes(3 * vertex + axis, k));
    table += ',';
    if (job.cases.topology) {
      const Points offset = points_of(shapes, k) - points_of(mean);
      table += number(outward_mm(Mesh{job.cases.topology, points_of(mean)}, offset)[vertex]);
    }
    table += '\n';
  }
  return write_table(job, file, table);
}

/// The tables that --csv asks for; gives the path of that of the vertices, null without one.
Result<Json> write_tables(TestJob& job, Progress& progress) {
  const fs::path& tables = job.options.tables;
  const auto folder = ResultFolder::make(tables);
  if (!folder) return fail(folder.error());
  if (auto done = write_cases(job, tables / "cases.csv"); !done) return fail(done.error());
  for (const Eigen::Index vertex : job.options.at)
    if (auto done = write_places(job, vertex, tables / ("vertex-" + std::to_string(vertex) + ".csv")); !done)
      return fail(done.error());
  if (!job.of_shape()) return Json();
  const fs::path landmarks = tables / "landmarks.csv";
  if (auto done = write_landmarks(job, landmarks, progress); !done) return fail(done.error());
  return Json(landmarks.string());
}

Json json_of(const LinearTest& test, const TestJob& job) {
  Json terms = Json::array(), pairs = Json::array();
  for (const TermTest& one : test.terms)
    terms.push_back({{"name", one.name},
                     {"df", one.df},
                     {"ss", one.ss},
                     {"r2", one.r2},
                     {"partial_r2", one.partial_r2},
                     {"f", one.f},
                     {"z", one.z},
                     {"p", one.p}});
  // Of shapes the root mean square over the vertices; of numbers their difference.
  const double share = job.of_shape() ? std::sqrt(job.vertices()) : 1;
  for (const PairTest& one : test.pairs)
    pairs.push_back({{"term", one.term},
                     {"a", one.a},
                     {"b", one.b},
                     {job.of_shape() ? "distance_mm" : "difference", one.distance / share},
                     {"p", one.p},
                     {"q", one.q}});
  return {{"terms", std::move(terms)},
          {"residual", {{"df", test.residual_df}, {"ss", test.residual_ss}}},
          {"total", {{"df", job.design.cases() - 1}, {"ss", test.total_ss}}},
          {"pairs", std::move(pairs)}};
}

Json report_of(const TestJob& job, const LinearTest& test) {
  Json values{{"shapes", job.design.cases()},
              {"vertices", job.cases.shapes.rows() / 3},
              {"formula", job.options.formula},
              {"permutations", job.permutations.rows()},
              {"sided", "two"}};
  if (job.modes > 0) values["modes"] = job.modes;
  values.update(json_of(test, job));
  if (!job.cases.doubt_mm.empty()) {
    const Eigen::VectorXd weights = job.root_weights.cwiseAbs2();
    values["weights"] = {{"min", weights.minCoeff()}, {"mean", weights.mean()}, {"max", weights.maxCoeff()}};
  }
  values["landmarks"] = nullptr;
  values["left_out"] = Json::array();
  for (const DoubtfulShape& one : job.cases.left_out)
    values["left_out"].push_back({{"name", one.name}, {"reason", one.reason}});
  return values;
}

Result<Report> run_test(TestOptions options, Progress& progress) {
  auto formula = read_formula(options.formula);
  if (!formula) return fail(formula.error());
  options.asked.formula = std::move(*formula);
  progress.part(0, 0.2);
  auto cases = read_test_cases(options.asked, progress);
  if (!cases) return fail(cases.error());
  TestJob job{options, std::move(*cases)};
  for (const Eigen::Index vertex : options.at)
    if (vertex >= job.cases.shapes.rows() / 3)
      return fail("--at", "names vertex " + std::to_string(vertex) + ", and the shapes have " +
                              std::to_string(job.cases.shapes.rows() / 3) + ", counted from 0");
  if (auto done = put_responses(job); !done) return fail(done.error());
  if (auto done = put_design(job, progress); !done) return fail(done.error());
  if (auto done = put_weights(job); !done) return fail(done.error());
  if (auto done = put_permutations(job); !done) return fail(done.error());
  progress.part(0.2, options.tables.empty() ? 1 : 0.4);
  const LinearTest test = test_terms(job.design, job.responses, job.root_weights, job.permutations, &progress);
  if (progress.cancelled()) return fail("", "cancelled");
  Report report;
  report.values = report_of(job, test);
  if (!options.tables.empty()) {
    auto landmarks = write_tables(job, progress);
    if (!landmarks) return fail(landmarks.error());
    report.values["landmarks"] = std::move(*landmarks);
    report.made = std::move(job.tables);
  }
  report.warnings = std::move(job.cases.warnings);
  return report;
}

}  // namespace

void add_test(CLI::App& app, CommandLine& asked) {
  auto options = std::make_shared<TestOptions>();
  CLI::App* verb = add_verb(app, "test", "Tests what shapes have to do with groups, ages, sizes and the like");
  add_set_options(*verb, options->asked.shapes);
  verb->add_option(
      "--covariates", options->asked.covariates,
      "A table (.csv) of what is known of the cases: a row a case, its name in the column name, case, id or "
      "the first (default: what the study knows)");
  verb->add_option(
          "--formula", options->formula,
          "What is tested, as \"shape ~ group + age + log(size)\"; also a:b, a*b, factor(x), and \"size ~ group\" "
          "or \"age ~ shape\"")
      ->required();
  auto* count = verb->add_option("--permutations", options->permutations, "How often residuals are permuted")
                    ->check(CLI::Range(1, 1000000));
  auto* seed = verb->add_option("--seed", options->seed, "Other permutations");
  verb->add_option("--permutation-file", options->permutation_file,
                   "Take the permutations of this file: one a line, the cases counted from 0")
      ->excludes(count)
      ->excludes(seed);
  verb->add_option(
      "--paired", options->asked.paired,
      "A column whose values (subjects) hold cases that belong together: it is taken out, and cases change "
      "places within it alone");
  verb->add_flag("--by-doubt", options->asked.with_doubt, "Cases in more doubt weigh less");
  verb->add_option("--modes", options->modes,
                   "Of \"age ~ shape\": how many modes explain (default: those that hold more than chance)")
      ->check(CLI::Range(1, 10000));
  auto* tables = verb->add_option("--csv", options->tables, "Folder for cases.csv and, of shapes, landmarks.csv");
  verb->add_option("--at", options->at, "Also write where each case has this vertex (N,N,…) into vertex-N.csv there")
      ->delimiter(',')
      ->check(CLI::NonNegativeNumber)
      ->needs(tables);
  verb->callback(
      [options, &asked] { asked.run = [options](Progress& progress) { return run_test(*options, progress); }; });
}

}  // namespace homolog
