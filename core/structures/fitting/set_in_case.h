#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/case/action.h"
#include "core/case/actions/kept_structures.h"
#include "core/case/document.h"
#include "core/structures/fitting/fit_set.h"

namespace homolog {

/// The steps that bring what was fitted of a set into a case, as its structures at the shown frame: each with its name,
/// label, colour, confidence, side and mesh (LPS mm), then its partner and what it shares. They are one step to undo. A
/// structure of the case that has the name and the template gets the new mesh. So does one without a name that nobody
/// edited, where it has the same template; others of that kind go, and one that has the name and another template.
/// Empty where nothing was fitted. `found`: of each structure of the set what a repair found, which a person has to
/// look at; may be empty.
std::vector<EditStep> steps_of_fitted_set(const Document& document, const SetOfTemplates& set, const SetInMap& subject,
                                          const FittedSet& fitted, const std::vector<std::string>& found = {});

/// The structures that such steps bring, as they are in the label map: name, layer, value, mesh, and how sure the name
/// is.
KeptMapFit map_fit_of(const TemplateSet& set, const SetInMap& subject, const FittedSet& fitted,
                      const std::vector<EditStep>& steps, int frame);

/// The edit that moves a structure (`of`: its id) out of the others of its case at the shown frame, where they lie
/// within each other or nearer than `gap_mm`. It alone moves [keep_apart]. Others that hold it for the most part, or
/// that it holds, as a chamber lies within its wall, are left out. Vertices that it shares with others stay. None where
/// nothing meets, or where a mesh is open.
std::optional<SetPoints> apart_from_others(const Document& document, const std::string& of, double gap_mm = 0);

/// An id that no structure of the case has, nor one of `more`: "s3".
std::string free_structure_id(const Document& document, const std::vector<std::string>& more = {});

}  // namespace homolog
