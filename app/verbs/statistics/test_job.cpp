#include "app/verbs/statistics/test_job.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>

#include "core/base/text/text.h"
#include "core/statistics/parallel_analysis.h"

namespace homolog {

namespace {

/// Sizes or a column as numbers.
Result<Eigen::VectorXd> numbers_asked(const TestCases& cases, const Variable& variable) {
  if (cases.table.column(variable.name)) return numbers_of(cases.table, cases.rows, variable);
  return transformed(variable, cases.sizes_mm, [&](Eigen::Index k) { return cases.names[k]; });
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
  const TakenOut why = asked.object_symmetry ? TakenOut{"a case and its mirror image", "--object-symmetry"}
                                             : TakenOut{"all cases of a " + asked.paired, "--paired"};
  auto design = make_design(terms, asked.paired.empty() ? 0 : 1, code, why);
  if (!design) return fail(design.error());
  job.design = std::move(*design);
  for (const std::string& term : job.design.taken)
    job.cases.warnings.push_back(term + ": is the same in " + why.same_in + ", so " + why.option +
                                 " takes it out; its interactions are tested");
  for (const DesignTerm& term : job.design.terms)
    if (term.left_out > 0)
      job.cases.warnings.push_back(
          term.name + ": has " + std::to_string(term.count) + " df and not " +
          std::to_string(term.count + term.left_out) +
          ", since the others follow from these, as where a combination of groups has no case");
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
  if (!job.options.by_doubt) return {};
  std::size_t unknown = 0;
  for (const double doubt : doubts) unknown += std::isnan(doubt) ? 1 : 0;
  if (unknown == doubts.size())
    return fail("--by-doubt", "has no effect: none of the shapes has a doubt, which fit and study write into them");
  if (unknown > 0)
    job.cases.warnings.push_back(std::to_string(unknown) + " of the shapes have no doubt and count in full");
  const Permutations none(0, job.design.cases());
  const LinearTest plain = test_terms(job.design, job.cases.shapes, job.root_weights, none);
  // Shapes that explain themselves leave nothing: then what counts is how they scatter.
  const double left = job.modes > 0 ? plain.total_ss / (static_cast<double>(job.design.cases() - 1) * job.vertices())
                                    : plain.residual_ss / (static_cast<double>(plain.residual_df) * job.vertices());
  for (std::size_t k = 0; k < doubts.size(); ++k)
    if (!std::isnan(doubts[k]))
      job.root_weights[static_cast<Eigen::Index>(k)] = std::sqrt(left / (left + doubts[k] * doubts[k]));
  if (const double count = job.cases_by_weight(); count < 0.5 * static_cast<double>(job.design.cases())) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "by their weights the %d cases count as %.1f, since few have little doubt; test without --by-doubt "
                  "too, or leave the doubtful ones out",
                  static_cast<int>(job.design.cases()), count);
    job.cases.warnings.emplace_back(text);
  }
  return {};
}

/// Fewer than so many orders are told: then p is coarse.
constexpr double few_orders = 200;

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
  if (const double orders = std::round(different_orders(blocks, job.design.columns)); orders < few_orders) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "the cases can change places in %.0f ways that differ, so no p can be below %.2g, however many "
                  "permutations there are; take more cases",
                  orders, 1 / orders);
    job.cases.warnings.emplace_back(text);
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
      if (const int other = job.permutations(row, static_cast<Eigen::Index>(k)); blocks[k] != blocks[other])
        return fail(job.options.permutation_file.string(), "permutation " + std::to_string(row + 1) +
                                                               " moves cases from one " + paired +
                                                               " to another; pairs have to stay together");
  return {};
}

/// Errors: a function of what it has no value for.
Result<void> check_functions(const Formula& formula, const CovariateTable& table) {
  std::vector<Variable> variables{formula.response};
  for (const FormulaTerm& term : formula.terms) variables.insert(variables.end(), term.begin(), term.end());
  if (const auto column = table.column(formula.response.name); column && formula.response.name != "shape") {
    const auto is_number = [&](const std::vector<std::string>& row) {
      return as_number<double>(row[*column]).has_value();
    };
    if (std::ranges::none_of(table.cells, is_number))
      return fail(
          formula.response.text(),
          "is what is tested, and groups are no number; test shape by them instead: shape ~ " + formula.response.name);
  }
  for (const Variable& one : variables) {
    if (one.by == Variable::By::itself) continue;
    if (one.name == "shape")
      return fail(one.text(), "is of shapes, which are no numbers; write shape, or a function of size");
    const bool is_size = one.name == "size" && !table.column("size");
    if (one.by == Variable::By::factor && (is_size || one == formula.response))
      return fail(one.text(), is_size ? "is of sizes, which name no groups; write size, or log(size)"
                                      : "is what is tested, and groups are no number; test shape by them instead");
  }
  return {};
}

/// Errors: options about shapes where none are in the formula.
Result<void> check_of_shapes(const TestJob& job) {
  const Formula& formula = job.options.asked.formula;
  const bool explains = std::ranges::any_of(formula.terms, [](const FormulaTerm& term) {
    return std::ranges::any_of(term, [](const Variable& one) { return one.name == "shape"; });
  });
  if (job.options.modes > 0 && !explains)
    return fail("--modes", "has no effect: it is for a formula with shape behind the ~; leave it out");
  if (!job.options.asked.direction.empty() && !explains && !job.of_shape())
    return fail("--without-direction", "has no effect: no shape is in the formula; leave it out");
  return {};
}

/// Errors: a side of what has none.
Result<void> check_sided(const TestJob& job) {
  if (job.options.asked.object_symmetry && !job.of_shape())
    return fail("--object-symmetry", "compares shapes with their mirror images; write shape before the ~");
  if (job.options.sided == Sided::two) return {};
  const std::string option = "--sided " + job.options.sided_word;
  if (job.of_shape())
    return fail(option,
                "has no meaning for shapes, which differ in many directions at once; test a number, as size, or read "
                "outward_mm of each vertex");
  if (std::ranges::none_of(job.design.terms, [](const DesignTerm& one) { return one.tested && has_direction(one); }))
    return fail(option, "needs a term of two groups or of a number, which the formula lacks; leave the option out");
  return {};
}

}  // namespace

Result<TestJob> test_job(const TestOptions& options, Progress& progress) {
  auto cases = read_test_cases(options.asked, progress);
  if (!cases) return fail(cases.error());
  if (auto known = check_functions(options.asked.formula, cases->table); !known) return fail(known.error());
  TestJob job{options, std::move(*cases)};
  if (auto usable = check_of_shapes(job); !usable) return fail(usable.error());
  if (auto done = put_responses(job); !done) return fail(done.error());
  if (auto done = put_design(job, progress); !done) return fail(done.error());
  if (auto done = check_sided(job); !done) return fail(done.error());
  if (auto done = put_weights(job); !done) return fail(done.error());
  if (auto done = put_permutations(job); !done) return fail(done.error());
  return job;
}

LinearTest tests_of(const TestJob& job, const Eigen::MatrixXd& responses, Progress& progress) {
  return test_terms(job.design, responses, job.root_weights, job.permutations, &progress, job.options.sided);
}

}  // namespace homolog
