#include <cmath>
#include <filesystem>

#include "app/verbs/test_job.h"
#include "core/base/files.h"
#include "core/mesh/formats/formats.h"
#include "core/model/groups.h"
#include "core/model/model_files.h"
#include "core/statistics/landmark_test.h"

// The verb `test`: what shapes have to do with what is known of their cases.

namespace homolog {

namespace fs = std::filesystem;

namespace {

std::string case_named(const TestCases& cases, Eigen::Index k) {
  return cases.names[static_cast<std::size_t>(k)];
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
    progress.part(0.4 + 0.4 * static_cast<double>(t) / terms, 0.4 + 0.4 * static_cast<double>(t + 1) / terms);
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
  if (job.options.by_doubt) {
    const Eigen::VectorXd weights = job.root_weights.cwiseAbs2();
    values["weights"] = {{"min", weights.minCoeff()}, {"mean", weights.mean()}, {"max", weights.maxCoeff()}};
  }
  values["landmarks"] = nullptr;
  values["left_out"] = Json::array();
  for (const DoubtfulShape& one : job.cases.left_out)
    values["left_out"].push_back({{"name", one.name}, {"reason", one.reason}});
  return values;
}

/// The vertices of which all cases together are in less doubt than they scatter, as rows of coordinates; all of them
/// where nothing is known.
std::vector<Eigen::Index> sure_coordinates(const TestCases& cases) {
  const Eigen::VectorXd mean = cases.shapes.rowwise().mean();
  std::vector<Eigen::Index> rows;
  for (Eigen::Index v = 0; v < cases.shapes.rows() / 3; ++v) {
    const double scatter = (cases.shapes.middleRows(3 * v, 3).colwise() - mean.segment<3>(3 * v)).squaredNorm() /
                           static_cast<double>(cases.shapes.cols() - 1);
    if (cases.vertex_doubt_mm.size() > 0 && cases.vertex_doubt_mm[v] * cases.vertex_doubt_mm[v] > scatter) continue;
    for (const Eigen::Index axis : {0, 1, 2}) rows.push_back(3 * v + axis);
  }
  return rows;
}

/// The same test of other shapes or of fewer vertices.
struct TestAgain {
  std::string of;
  LinearTest test;
};

Result<std::vector<TestAgain>> tests_again(const TestJob& job, std::vector<std::string>& warnings, Progress& progress) {
  std::vector<TestAgain> again;
  if (const auto sure = sure_coordinates(job.cases); job.of_shape() && std::ssize(sure) < job.cases.shapes.rows()) {
    const Eigen::Index vertices = job.cases.shapes.rows() / 3, kept = std::ssize(sure) / 3;
    const std::string doubtful = std::to_string(vertices - kept);
    if (sure.empty())
      warnings.emplace_back("every vertex is in more doubt than the cases scatter");
    else if (2 * kept < vertices)
      warnings.push_back("only " + std::to_string(kept) + " of " + std::to_string(vertices) +
                         " vertices are in less doubt than the cases scatter, so \"without the " + doubtful +
                         " vertices in doubt\" says little");
    if (!sure.empty())
      again.push_back(
          {"without the " + doubtful + " vertices in doubt", tests_of(job, job.responses(sure, Eigen::all), progress)});
  }
  for (const fs::path& folder : job.options.templates) {
    TestOptions options = job.options;
    options.asked.shapes.files = {folder};
    options.at.clear();
    auto other = test_job(options, progress);
    if (!other) return fail(other.error());
    for (const std::string& warning : other->cases.warnings) warnings.push_back(folder.string() + ": " + warning);
    if (other->cases.names != job.cases.names)
      warnings.push_back(folder.string() + ": has other cases (" + std::to_string(other->cases.names.size()) +
                         " where there are " + std::to_string(job.cases.names.size()) +
                         "), so its p may differ by that");
    again.push_back({folder.string(), tests_of(*other, other->responses, progress)});
  }
  return again;
}

/// Adds what the test gives without the vertices in doubt and in other templates, and one line for each term.
Result<void> add_robustness(const TestJob& job, const LinearTest& test, Report& report, Progress& progress) {
  constexpr double level = 0.05;
  const auto again = tests_again(job, report.warnings, progress);
  if (!again) return fail(again.error());
  if (progress.cancelled()) return fail("", "cancelled");
  if (again->empty()) return {};
  Json rows = Json::array(), holds = Json::array();
  for (const TestAgain& one : *again) {
    Json terms = Json::array();
    for (const TermTest& term : one.test.terms)
      terms.push_back({{"name", term.name}, {"r2", term.r2}, {"f", term.f}, {"p", term.p}});
    rows.push_back({{"of", one.of}, {"terms", std::move(terms)}});
  }
  for (const TermTest& term : test.terms) {
    const bool found = term.p <= level;
    std::vector<std::string> with, against, without;
    for (const TestAgain& one : *again) {
      // Of other cases --paired may have taken another term out.
      const auto same = std::ranges::find(one.test.terms, term.name, &TermTest::name);
      (same == one.test.terms.end() ? without : (same->p <= level) == found ? with : against).push_back(one.of);
    }
    std::string sentence = term.name + (found ? ": p <= 0.05" : ": p > 0.05");
    if (!against.empty())
      sentence += ", but not " + listed(against, " and ");
    else if (!with.empty())
      sentence += ", and so " + listed(with, " and ");
    if (!without.empty()) sentence += "; " + listed(without, " and ") + " cannot test it";
    holds.push_back(std::move(sentence));
  }
  report.values["again"] = std::move(rows);
  report.values["holds"] = std::move(holds);
  return {};
}

Result<Report> run_test(TestOptions options, Progress& progress) {
  auto formula = read_formula(options.formula);
  if (!formula) return fail(formula.error());
  options.asked.formula = std::move(*formula);
  options.asked.shapes.reading.vertex_doubts = true;
  progress.part(0, 0.2);
  auto prepared = test_job(options, progress);
  if (!prepared) return fail(prepared.error());
  TestJob job = std::move(*prepared);
  progress.part(0.2, options.tables.empty() ? 0.8 : 0.4);
  const LinearTest test = tests_of(job, job.responses, progress);
  if (progress.cancelled()) return fail("", "cancelled");
  Report report;
  report.values = report_of(job, test);
  if (!options.tables.empty()) {
    auto landmarks = write_tables(job, progress);
    if (!landmarks) return fail(landmarks.error());
    report.values["landmarks"] = std::move(*landmarks);
    report.made = std::move(job.tables);
  }
  progress.part(0.8, 1);
  report.warnings = std::move(job.cases.warnings);
  if (auto added = add_robustness(job, test, report, progress); !added) return fail(added.error());
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
  verb->add_option("--without-direction", options->asked.direction,
                   "Two shapes, as a jaw closed and open: what the cases differ along the way from one to the other "
                   "is taken out first")
      ->expected(2)
      ->check(CLI::ExistingFile);
  verb->add_option("--structures", options->asked.shapes.structures,
                   "A structure of several, or A,B together: SHAPE is then a folder with CASE/A.ply, as fit SET writes "
                   "it")
      ->delimiter(',')
      ->excludes("--all-frames")
      ->excludes("--flip-mirrored")
      ->excludes("--group");
  verb->add_flag("--by-doubt", options->by_doubt, "Cases in more doubt weigh less");
  verb->add_option("--modes", options->modes,
                   "Of \"age ~ shape\": how many modes explain (default: those that hold more than chance)")
      ->check(CLI::Range(1, 10000));
  verb->add_option("--templates", options->templates,
                   "Shapes of the same cases in other templates, a folder or a study each: is the answer theirs too?")
      ->excludes("--without-direction");
  auto* tables = verb->add_option("--csv", options->tables, "Folder for cases.csv and, of shapes, landmarks.csv");
  verb->add_option("--at", options->at, "Also write where each case has this vertex (N,N,…) into vertex-N.csv there")
      ->delimiter(',')
      ->check(CLI::NonNegativeNumber)
      ->needs(tables);
  verb->callback(
      [options, &asked] { asked.run = [options](Progress& progress) { return run_test(*options, progress); }; });
}

}  // namespace homolog
