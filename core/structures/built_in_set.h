#pragma once

#include <string>
#include <vector>

#include "core/mesh/mesh_io.h"
#include "core/structures/template_set.h"

namespace homolog {

/// A template set that Homolog makes itself, with its templates in memory. A structure's `file` is a name that
/// load_template takes [core/catalogue], so the set can also be written to a file.
struct BuiltInSet {
  TemplateSet set;
  std::vector<MeshFile> templates;  ///< one for each structure, where it lies in the set (LPS mm)
};

/// The set of a name [core/catalogue]: the mean of the spine phantoms. Errors: no such set.
Result<BuiltInSet> built_in_set(const std::string& source);

/// Whether a source is one of a set: the name of a set's file, or of a built-in set.
bool names_set(const std::string& source);

/// Reads a set's file, or makes a built-in set. Errors: those of either.
Result<TemplateSet> load_template_set(const std::string& source);

}  // namespace homolog
