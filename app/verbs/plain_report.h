#pragma once

#include <ostream>

#include "app/verbs/verb.h"

namespace homolog {

/// A number as people read it: four significant digits at least, no more than six decimals, no exponent.
std::string plain_number(double value);

/// Prints a report for people: a line a value, and a list of cases as a table with a column a figure. If a figure is a
/// spread, the table has the mean. Lists of objects within its rows are tables below it, other lists are left to
/// --json.
void print_report(const Json& values, std::ostream& out);

}  // namespace homolog
