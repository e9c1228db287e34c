#include "core/statistics/design.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/text/text.h"

namespace homolog {

namespace {

constexpr double determined = 1e-9;  ///< share of a column's length that is left of it after those before it

std::optional<double> finite_number(const std::string& cell) {
  const auto number = as_number<double>(cell);
  return number && std::isfinite(*number) ? number : std::nullopt;
}

bool is_part_of(const FormulaTerm& part, const FormulaTerm& whole) {
  return part.size() < whole.size() && std::all_of(part.begin(), part.end(), [&](const Variable& one) {
           return std::find(whole.begin(), whole.end(), one) != whole.end();
         });
}

/// Each column of one times each of the other.
Eigen::MatrixXd products(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  Eigen::MatrixXd all(a.rows(), a.cols() * b.cols());
  for (Eigen::Index j = 0; j < b.cols(); ++j)
    for (Eigen::Index i = 0; i < a.cols(); ++i) all.col(j * a.cols() + i) = a.col(i).cwiseProduct(b.col(j));
  return all;
}

/// Whether the constant and the first `terms` terms of a design leave nothing of these columns.
bool determines(const Design& design, std::size_t terms, const Eigen::MatrixXd& columns) {
  const DesignTerm& last = design.terms[terms - 1];
  const Eigen::MatrixXd known = design.columns.leftCols(last.first + last.count);
  const Eigen::MatrixXd rest = columns - known * known.colPivHouseholderQr().solve(columns);
  return (rest.colwise().norm().array() <= determined * columns.colwise().norm().array()).all();
}

Result<void> refuse_determined(const Design& design, std::size_t taken_out, const TakenOut& why) {
  Eigen::MatrixXd scaled = design.columns;
  for (Eigen::Index j = 1; j < scaled.cols(); ++j)
    if (const double length = (scaled.col(j).array() - scaled.col(j).mean()).matrix().norm(); length > 0)
      scaled.col(j) /= length;
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(scaled);
  for (const DesignTerm& term : design.terms) {
    bool free = term.count > 0;
    for (Eigen::Index j = term.first; j < term.first + term.count; ++j)
      free = free && std::abs(qr.matrixQR()(j, j)) > determined;
    if (free) continue;
    if (taken_out > 0 && term.tested && term.count > 0 &&
        determines(design, taken_out, design.columns.middleCols(term.first, term.count)))
      return fail("--formula", "the term " + term.name + " is the same in " + why.same_in + ", so " + why.option +
                                   " takes it out and nothing is left to test; test its interaction with another "
                                   "term, or leave out " +
                                   why.option);
    return fail("--formula", "the term " + term.name +
                                 " is already determined by the terms before it, so nothing is left to test; "
                                 "leave one of them out");
  }
  return {};
}

/// Leaves out the columns of an interaction that its parts, what is taken out and its columns before determine, as
/// where no case has two of its groups. `kept`: the variables of the design's terms.
void leave_out_determined(const Design& design, std::size_t taken_out, const std::vector<FormulaTerm>& kept,
                          const FormulaTerm& variables, DesignTerm& term, Eigen::MatrixXd& columns) {
  std::vector<Eigen::Index> order{0};
  for (std::size_t t = 0; t < kept.size(); ++t)
    if (t < taken_out || is_part_of(kept[t], variables))
      for (Eigen::Index j = 0; j < design.terms[t].count; ++j) order.push_back(design.terms[t].first + j);
  Eigen::MatrixXd known = design.columns(Eigen::all, order);
  std::vector<Eigen::Index> free;
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    const Eigen::VectorXd column = columns.col(j);
    const Eigen::VectorXd rest = column - known * known.colPivHouseholderQr().solve(column);
    if (!(rest.norm() > determined * column.norm())) continue;
    free.push_back(j);
    known.conservativeResize(Eigen::NoChange, known.cols() + 1);
    known.rightCols(1) = column;
  }
  term.left_out = columns.cols() - std::ssize(free);
  if (term.left_out == 0) return;
  columns = Eigen::MatrixXd(columns(Eigen::all, free));
  term.count = columns.cols();
}

Result<DesignTerm> coded_term(const FormulaTerm& variables,
                              const std::function<Result<CodedVariable>(const Variable&)>& code,
                              Eigen::MatrixXd& columns) {
  DesignTerm term;
  term.name = text_of(variables);
  for (const Variable& variable : variables) {
    auto coded = code(variable);
    if (!coded) return fail(coded.error());
    if (variables.size() == 1) {
      term.levels = coded->levels;
      term.numbers = coded->levels.empty() && coded->columns.cols() == 1;
    }
    columns = columns.size() == 0 ? std::move(coded->columns) : products(columns, coded->columns);
  }
  term.count = columns.cols();
  return term;
}

}  // namespace

Result<CodedVariable> coded_numbers(const std::string& variable, const Eigen::VectorXd& values) {
  const Eigen::ArrayXd centred = values.array() - values.mean();
  const double deviation = std::sqrt(centred.square().sum() / std::max(1.0, static_cast<double>(values.size()) - 1));
  if (!(deviation > determined * values.cwiseAbs().maxCoeff()))
    return fail(variable, "is the same for every case that is tested; leave it out of the formula");
  return CodedVariable{(centred / deviation).matrix(), {}};
}

Result<CodedVariable> coded_groups(const std::string& variable, const std::vector<std::string>& values) {
  std::map<std::string, Eigen::Index> sizes;
  for (const std::string& value : values) ++sizes[value];
  if (sizes.size() < 2) return fail(variable, "has one group only (" + values.front() + "); a test needs two");
  CodedVariable coded;
  for (const auto& [level, size] : sizes) {
    if (size == 1)
      return fail(variable, "has a single case in the group " + level + "; leave the case out or join groups");
    coded.levels.push_back(level);
  }
  if (std::all_of(coded.levels.begin(), coded.levels.end(),
                  [](const std::string& level) { return finite_number(level).has_value(); }))
    std::stable_sort(coded.levels.begin(), coded.levels.end(),
                     [](const std::string& a, const std::string& b) { return *finite_number(a) < *finite_number(b); });
  coded.columns.setZero(static_cast<Eigen::Index>(values.size()), static_cast<Eigen::Index>(coded.levels.size()) - 1);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto level = std::find(coded.levels.begin(), coded.levels.end(), values[i]) - coded.levels.begin();
    if (level > 0) coded.columns(static_cast<Eigen::Index>(i), level - 1) = 1;
  }
  return coded;
}

Result<Eigen::VectorXd> transformed(const Variable& variable, Eigen::VectorXd values,
                                    const std::function<std::string(Eigen::Index)>& named) {
  const bool log = variable.by == Variable::By::log;
  if (!log && variable.by != Variable::By::sqrt) return values;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (log ? values[i] <= 0 : values[i] < 0)
      return fail(variable.text(), "is not defined for " + named(i) + ", whose value is " +
                                       (values[i] == 0 ? "0" : "negative") + "; leave the case out or take " +
                                       variable.name + " as it is");
    values[i] = log ? std::log(values[i]) : std::sqrt(values[i]);
  }
  return values;
}

Result<Eigen::VectorXd> numbers_of(const CovariateTable& table, const std::vector<std::size_t>& rows,
                                   const Variable& variable) {
  const std::size_t column = *table.column(variable.name);
  Eigen::VectorXd values(static_cast<Eigen::Index>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::string& cell = table.cells[rows[i]][column];
    const auto number = finite_number(cell);
    if (!number)
      return fail(table.source, "has \"" + cell + "\" for " + table.cases[rows[i]] + " where " + variable.name +
                                    " should be a number; correct it, or leave the cell empty");
    values[static_cast<Eigen::Index>(i)] = *number;
  }
  return transformed(variable, std::move(values), [&](Eigen::Index i) { return table.cases[rows[i]]; });
}

Result<CodedVariable> coded_column(const CovariateTable& table, const std::vector<std::size_t>& rows,
                                   const Variable& variable) {
  const std::size_t column = *table.column(variable.name);
  std::vector<std::string> cells;
  std::size_t numbers = 0;
  for (const std::size_t row : rows) {
    cells.push_back(table.cells[row][column]);
    numbers += finite_number(cells.back()) ? 1 : 0;
  }
  // A few words among many numbers are a slip; numbers among words may name groups.
  const bool is_text = 2 * numbers <= cells.size();
  if (variable.by == Variable::By::factor || (variable.by == Variable::By::itself && is_text))
    return coded_groups(variable.name, cells);
  auto values = numbers_of(table, rows, variable);
  if (!values) return fail(values.error());
  return coded_numbers(variable.text(), *values);
}

Result<Design> make_design(const std::vector<FormulaTerm>& terms, std::size_t taken_out,
                           const std::function<Result<CodedVariable>(const Variable&)>& code, const TakenOut& why) {
  Design design;
  Eigen::Index asked = 1;  // parameters, with those that are left out
  std::vector<FormulaTerm> kept;
  for (std::size_t t = 0; t < terms.size(); ++t) {
    Eigen::MatrixXd columns;
    auto term = coded_term(terms[t], code, columns);
    if (!term) return fail(term.error());
    if (design.columns.size() == 0) design.columns = Eigen::MatrixXd::Ones(columns.rows(), 1);
    const bool in_another =
        std::any_of(terms.begin(), terms.end(), [&](const FormulaTerm& other) { return is_part_of(terms[t], other); });
    if (taken_out > 0 && t >= taken_out && in_another && determines(design, taken_out, columns)) {
      design.taken.push_back(term->name);
      continue;
    }
    asked += term->count;
    if (terms[t].size() > 1) leave_out_determined(design, taken_out, kept, terms[t], *term, columns);
    term->first = design.columns.cols();
    term->tested = t >= taken_out;
    design.columns.conservativeResize(Eigen::NoChange, term->first + term->count);
    design.columns.rightCols(term->count) = columns;
    design.terms.push_back(std::move(*term));
    kept.push_back(terms[t]);
  }
  for (std::size_t t = 0; t < kept.size(); ++t)
    for (std::size_t other = 0; other < kept.size(); ++other)
      if (is_part_of(kept[t], kept[other])) design.terms[t].holders.push_back(other);
  if (design.cases() <= design.parameters())
    return fail("--formula", "has " + std::to_string(asked) + " parameters, and " + std::to_string(design.cases()) +
                                 " cases are left to be tested; give more cases or fewer terms");
  if (auto free = refuse_determined(design, taken_out, why); !free) return fail(free.error());
  return design;
}

TermBasis basis_of(const Design& design, std::size_t term, const Eigen::VectorXd& root_weights) {
  const DesignTerm& of = design.terms[term];
  const auto is_holder = [&](std::size_t t) {
    return std::find(of.holders.begin(), of.holders.end(), t) != of.holders.end();
  };
  std::vector<Eigen::Index> order{0};
  const auto take = [&](const DesignTerm& one) {
    for (Eigen::Index j = 0; j < one.count; ++j) order.push_back(one.first + j);
  };
  for (std::size_t t = 0; t < design.terms.size(); ++t)
    if (t != term && !is_holder(t)) take(design.terms[t]);
  const auto reduced = static_cast<Eigen::Index>(order.size());
  take(of);
  for (const std::size_t t : of.holders) take(design.terms[t]);
  const Eigen::MatrixXd columns = root_weights.asDiagonal() * design.columns(Eigen::all, order);
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(columns);
  const Eigen::MatrixXd q = qr.householderQ() * Eigen::MatrixXd::Identity(columns.rows(), columns.cols());
  const auto upper = qr.matrixQR().block(reduced, reduced, of.count, of.count).triangularView<Eigen::Upper>();
  TermBasis basis{q.leftCols(reduced), q.middleCols(reduced, of.count), q.rightCols(q.cols() - reduced - of.count), {}};
  basis.contrasts = upper.solve(basis.added.transpose());
  return basis;
}

bool are_equal(const Eigen::VectorXd& root_weights) {
  return (root_weights.array() == root_weights[0]).all();
}

}  // namespace homolog
