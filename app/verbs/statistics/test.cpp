#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <utility>

#include "app/verbs/input_folders.h"
#include "app/verbs/statistics/test_job.h"
#include "app/verbs/statistics/test_tables.h"
#include "core/base/text/listed.h"
#include "core/mesh/formats/formats.h"

// The verb `test`: what shapes have to do with what is known of their cases.

namespace homolog {

namespace fs = std::filesystem;

namespace {

constexpr std::array<std::pair<Sided, const char*>, 3> sides{
    {{Sided::two, "two"}, {Sided::greater, "greater"}, {Sided::less, "less"}}};

const char* word_of(Sided sided) {
  return std::ranges::find(sides, sided, &std::pair<Sided, const char*>::first)->second;
}

Json described_test(const LinearTest& test, const TestJob& job) {
  Json terms = Json::array(), pairs = Json::array();
  Json taken_out = Json::array();
  for (const TermTest& one : test.terms) {
    terms.push_back({{"name", one.name},
                     {"df", one.df},
                     {"ss", one.ss},
                     {"r2", one.r2},
                     {"partial_r2", one.partial_r2},
                     {"f", one.f},
                     {"z", one.z},
                     {"p", one.p},
                     {"sided", word_of(one.sided)}});
    if (!job.of_shape()) terms.back()["change"] = std::isnan(one.change) ? Json() : Json(one.change);
  }
  for (const TermSum& one : test.taken_out)
    taken_out.push_back({{"name", one.name}, {"df", one.df}, {"ss", one.ss}, {"r2", one.r2}});
  // Of shapes the root mean square over the vertices; of numbers their difference.
  const double share = job.of_shape() ? std::sqrt(job.vertices()) : 1;
  for (const PairTest& one : test.pairs)
    pairs.push_back({{"term", one.term},
                     {"a", one.a},
                     {"b", one.b},
                     {job.of_shape() ? "distance_mm" : "difference", one.distance / share},
                     {"p", one.p},
                     {"q", one.q}});
  Json values{{"terms", std::move(terms)},
              {"residual", {{"df", test.residual_df}, {"ss", test.residual_ss}}},
              {"total", {{"df", job.design.cases() - 1}, {"ss", test.total_ss}}},
              {"pairs", std::move(pairs)}};
  if (!taken_out.empty()) values["taken_out"] = std::move(taken_out);
  return values;
}

Json report_of_test(const TestJob& job, const LinearTest& test) {
  Json values{{"shapes", job.design.cases()},
              {"vertices", job.cases.shapes.rows() / 3},
              {"formula", job.options.formula},
              {"permutations", job.permutations.rows()},
              {"sided", word_of(job.options.sided)}};
  if (job.modes > 0) values["modes"] = job.modes;
  values.update(described_test(test, job));
  if (job.options.by_doubt) {
    const Eigen::VectorXd weights = job.root_weights.cwiseAbs2();
    values["weights"] = {{"min", weights.minCoeff()},
                         {"mean", weights.mean()},
                         {"max", weights.maxCoeff()},
                         {"cases", job.cases_by_weight()}};
  }
  if (job.options.asked.object_symmetry) values["symmetry_off_mm"] = job.cases.symmetry_off_mm;
  if (const auto pairs = subject_pairs(job); !pairs.empty()) {
    values["subjects"] = Json::array();
    for (const SubjectPair& one : pairs)
      values["subjects"].push_back(
          {{"name", one.name}, {"difference_mm", one.difference_mm}, {"individual_mm", one.individual_mm}});
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
    if (!other) return fail(folder.string() + " (--templates)", other.error().sentence());
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
  if (options.asked.object_symmetry) options.asked.paired = whose_column;
  if (auto there = check_there(options.asked.direction); !there) return fail(there.error());
  options.asked.shapes.reading.vertex_doubts = true;
  progress.part(0, 0.2);
  auto prepared = test_job(options, progress);
  if (!prepared) return fail(prepared.error());
  TestJob job = std::move(*prepared);
  progress.part(0.2, options.tables.empty() ? 0.8 : 0.4);
  const LinearTest test = tests_of(job, job.responses, progress);
  if (progress.cancelled()) return fail("", "cancelled");
  Report report;
  report.values = report_of_test(job, test);
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
      "or \"age ~ shape\"");
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
  verb->add_flag(
          "--object-symmetry", options->asked.object_symmetry,
          "Of an organ that is symmetric in itself, as a vertebra: each shape counts as it is and as its mirror "
          "image, and \"mirrored\" is a word of the formula (default: \"shape ~ mirrored\", directional asymmetry)")
      ->excludes("--paired")
      ->excludes("--no-align")
      ->excludes("--all-frames");
  verb->add_option("--sided", options->sided_word,
                   "two (default), or of a number whether it is greater or less in the second group, or with larger "
                   "numbers")
      ->check(CLI::IsMember({"two", "greater", "less"}));
  verb->add_option("--without-direction", options->asked.direction,
                   "Two shapes, as a jaw closed and open: what the cases differ along the way from one to the other "
                   "is taken out first")
      ->expected(2);
  verb->add_option("--structures", options->asked.shapes.structures,
                   "A structure of several, or A,B together: SHAPE is then a folder with CASE/A.ply, as fit SET writes "
                   "it")
      ->delimiter(',')
      ->excludes("--all-frames")
      ->excludes("--flip-mirrored")
      ->excludes("--object-symmetry")
      ->excludes("--group");
  verb->add_flag("--by-doubt", options->by_doubt, "Cases in more doubt weigh less");
  verb->add_option("--modes", options->modes,
                   "Of \"age ~ shape\": how many modes explain (default: those that hold more than chance)")
      ->check(CLI::Range(1, 10000));
  verb->add_option("--templates", options->templates,
                   "Shapes of the same cases in other templates, a folder or a study each: is the answer theirs too?")
      ->excludes("--without-direction");
  auto* tables = verb->add_option("--csv", options->tables, "Folder for cases.csv and, of shapes, landmarks.csv");
  verb->add_option("--at", options->at,
                   "Also write where each case has these vertices (their numbers) or landmarks (their names) into "
                   "vertex-N.csv or landmark-NAME.csv there")
      ->delimiter(',')
      ->needs(tables);
  verb->callback([options, &asked] {
    for (const auto& [sided, word] : sides)
      if (options->sided_word == word) options->sided = sided;
    if (options->formula.empty() && options->asked.object_symmetry)
      options->formula = std::string("shape ~ ") + mirrored_column;
    if (options->formula.empty()) throw CLI::RequiredError("--formula");
    auto formula = read_formula(options->formula);
    if (!formula) throw CLI::ValidationError("--formula", formula.error().what);
    options->asked.formula = std::move(*formula);
    asked.run = [options](Progress& progress) { return run_test(*options, progress); };
  });
}

}  // namespace homolog
