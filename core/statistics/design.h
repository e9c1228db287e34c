#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/statistics/covariates.h"
#include "core/statistics/formula.h"

namespace homolog {

/// A variable's values, coded: a row a case.
struct CodedVariable {
  Eigen::MatrixXd columns;  ///< numbers: one, mean 0 and deviation 1; groups: one for each but the first, 0 or 1
  std::vector<std::string> levels;  ///< names of the groups, sorted; empty: numbers
};

/// Codes one value a case. Errors (they name `variable`): a constant.
Result<CodedVariable> coded_numbers(const std::string& variable, const Eigen::VectorXd& values);
/// Treatment coding against the first group. Groups are sorted as numbers where all are numbers, else as text. Errors:
/// a single group, a group of one case.
Result<CodedVariable> coded_groups(const std::string& variable, const std::vector<std::string>& values);

/// A column of a table for the cases in `rows`: numbers, with their log or root where asked. Errors: text among
/// numbers, a logarithm of what is not above 0, a root of what is below 0.
Result<Eigen::VectorXd> numbers_of(const CovariateTable& table, const std::vector<std::size_t>& rows,
                                   const Variable& variable);
/// The same with the coding: groups where the column holds text or `factor` asks for it.
Result<CodedVariable> coded_column(const CovariateTable& table, const std::vector<std::size_t>& rows,
                                   const Variable& variable);
/// The natural logarithm or root of values, as the variable asks. `named`: says what an index is in an error.
Result<Eigen::VectorXd> transformed(const Variable& variable, Eigen::VectorXd values,
                                    const std::function<std::string(Eigen::Index)>& named);

/// A term's columns of the design.
struct DesignTerm {
  std::string name;
  Eigen::Index first = 0, count = 0;
  std::vector<std::string> levels;   ///< levels of a term of groups alone; else empty
  std::vector<std::size_t> holders;  ///< interactions that hold it
  bool tested = true;                ///< else it is taken out and no more
  bool numbers = false;              ///< one column of numbers
  Eigen::Index left_out = 0;  ///< columns of an interaction that its parts determine, as of groups without a case
};

/// A linear model: the constant, then the terms' columns.
struct Design {
  Eigen::MatrixXd columns;  ///< a row a case
  std::vector<DesignTerm> terms;
  std::vector<std::string> taken;  ///< terms that those taken out determine, and whose interactions are tested

  Eigen::Index cases() const { return columns.rows(); }
  Eigen::Index parameters() const { return columns.cols(); }
};

/// The words of errors on terms that are taken out.
struct TakenOut {
  std::string same_in = "what is taken out";  ///< the end of "the term … is the same in …"
  std::string option = "--paired";            ///< the option that takes them out
};

/// `code` gives a variable's columns. `taken_out`: the first so many terms are not tested. A term that they determine,
/// as the subjects of repeated measures do their group, is left out where an interaction has it. An interaction
/// loses the columns that its parts determine. Errors: code's, more
/// parameters than cases allow, a term that those before it already determine.
Result<Design> make_design(const std::vector<FormulaTerm>& terms, std::size_t taken_out,
                           const std::function<Result<CodedVariable>(const Variable&)>& code, const TakenOut& why = {});

/// The basis that testing a term needs: orthonormal columns, a row a case. The second kind of sums: the reduced model
/// has every term but this one and the interactions that hold it.
struct TermBasis {
  Eigen::MatrixXd reduced;    ///< the model without the term; its first column is the constant's
  Eigen::MatrixXd added;      ///< the columns that the term adds
  Eigen::MatrixXd rest;       ///< the columns that the interactions that hold it add
  Eigen::MatrixXd contrasts;  ///< a row a column of the term: times the responses it is the coefficient
};
/// `root_weights`: √w of each case; rows are multiplied with them first.
TermBasis basis_of(const Design& design, std::size_t term, const Eigen::VectorXd& root_weights);

/// Whether all cases weigh the same.
bool are_equal(const Eigen::VectorXd& root_weights);

}  // namespace homolog
