#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"

namespace homolog {

/// A word of a formula, and what is done with it.
struct Variable {
  enum class By { itself, log, sqrt, factor };
  By by = By::itself;
  std::string name;

  std::string text() const;  ///< its text in the formula: "log(size)"
  bool operator==(const Variable&) const = default;
};

/// One variable, or several: their interaction.
using FormulaTerm = std::vector<Variable>;
std::string text_of(const FormulaTerm& term);  ///< "a:b"

/// "shape ~ group + age + log(size)".
struct Formula {
  Variable response;
  std::vector<FormulaTerm> terms;  ///< the main effects first, then interactions of two, of three, …; none twice
};

/// Reads a formula in R's notation [Wilkinson & Rogers 1973]: + between terms, a:b an interaction, a*b the same as
/// a + b + a:b; log(x), sqrt(x), and factor(x) for numbers that name groups. A name with blanks or signs stands in
/// backquotes. Errors: no ~, an unknown sign or function, no terms, an interaction without its main effects.
Result<Formula> read_formula(const std::string& text);

}  // namespace homolog
