#pragma once

#include <string>
#include <vector>

#include "core/case/action.h"
#include "core/structures/fit_set.h"

namespace homolog {

/// The steps that bring what was fitted of a set into a case, as its structures at the shown frame: each with its name,
/// label, colour, confidence and mesh (LPS mm). They are one step to undo. A structure of the case that has the name
/// and as many vertices gets the new mesh. So does one without a name that nobody edited, where it has the same
/// template; others of that kind go. Empty where nothing was fitted. `found`: of each structure of the set what a
/// repair found, which a person has to look at; may be empty.
std::vector<EditStep> steps_of_fitted_set(const Document& document, const SetOfTemplates& set, const SetInMap& subject,
                                          const FittedSet& fitted, const std::vector<std::string>& found = {});

/// An id that no structure of the case has, nor one of `more`: "s3".
std::string free_structure_id(const Document& document, const std::vector<std::string>& more = {});

}  // namespace homolog
