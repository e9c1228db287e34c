#pragma once

#include <array>
#include <string>

#include "core/base/result.h"
#include "core/template/template.h"

namespace homolog {

/// The mark that tells a template from another one of the same faces: the mean place of its vertices (x, y, z; mm) and
/// their mean stiffness, with a weight of each vertex that goes by its number. So an exchanged, moved or painted file
/// is found, and one that was written with fewer digits is not.
using TemplateMark = std::array<double, 4>;
TemplateMark template_mark(const Template& the_template);

/// Compares the mark that a case keeps with the template that was loaded. Errors: its vertices lie elsewhere. A
/// sentence where its stiffness alone is another, so that strokes may lead elsewhere; empty where both are the same.
Result<std::string> check_template_mark(const TemplateMark& kept, const Template& loaded);

}  // namespace homolog
