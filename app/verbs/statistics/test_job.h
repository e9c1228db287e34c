#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "app/verbs/statistics/test_cases.h"
#include "core/statistics/design.h"
#include "core/statistics/linear_test.h"

namespace homolog {

/// The options of `test`.
struct TestOptions {
  TestCasesAsked asked;
  std::string formula;
  Eigen::Index permutations = 999, modes = 0;
  std::uint64_t seed = 1;
  std::filesystem::path permutation_file, tables;
  std::vector<std::string> at;                   ///< vertices by number and landmarks by name, whose places are written
  std::vector<std::filesystem::path> templates;  ///< shapes of the same cases in other templates, a folder each
  bool by_doubt = false;                         ///< cases in more doubt weigh less
  std::string sided_word = "two";
  Sided sided = Sided::two;
};

/// The data that tests compute with.
struct TestJob {
  TestOptions options;
  TestCases cases;
  Design design{};
  Eigen::MatrixXd responses{};  ///< a case a column
  Eigen::VectorXd root_weights{};
  Permutations permutations{};
  Eigen::Index modes = 0;                       ///< the number of modes by which the shape explains; else 0
  std::vector<std::filesystem::path> tables{};  ///< those that were written

  bool of_shape() const { return options.asked.formula.response.name == "shape"; }
  double vertices() const { return static_cast<double>(cases.shapes.rows()) / 3; }
  /// How many cases the weights leave: (Σw)² ÷ Σw².
  double cases_by_weight() const {
    const Eigen::VectorXd weights = root_weights.cwiseAbs2();
    return weights.sum() * weights.sum() / weights.squaredNorm();
  }
};

/// Reads the cases and brings them together with what the formula says. Errors: read_test_cases's; a word of the
/// formula that gives no column; no vertex of that number; permutations of other cases.
Result<TestJob> test_job(const TestOptions& options, Progress& progress);

/// The tests of all terms, of the job's responses or of some of them. If `progress` is cancelled, the result is worth
/// nothing.
LinearTest tests_of(const TestJob& job, const Eigen::MatrixXd& responses, Progress& progress);

}  // namespace homolog
