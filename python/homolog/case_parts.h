#pragma once

#include <memory>
#include <string>

#include "core/case/action.h"
#include "core/case/document.h"
#include "python/homolog/binding.h"
#include "python/homolog/held_case.h"

namespace homolog::python {

// What the sources of homolog.Case share.

using CaseType = py::class_<HeldCase, std::shared_ptr<HeldCase>>;

/// A structure of a case at the shown frame. `of`: its id; empty: the first. Errors: it has no mesh there.
ShapeView shown(const Document& document, const std::string& of);

/// Does an edit. Gives moved_mm, stopped_by_guard, on (LPS mm or None) and message. Errors: the case is closed, or in
/// use; the edit is refused. `since`: the case that the edit was computed of. It is refused where another call has
/// edited it meanwhile, whose edit it would take back.
py::dict apply(HeldCase& self, EditStep step, const std::shared_ptr<const Document>& since = nullptr);

// Each source adds its part.
void add_case_files(CaseType& type);
void add_case_edits(CaseType& type);
void add_case_fits(CaseType& type);
void add_case_views(CaseType& type);

}  // namespace homolog::python
