#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/mesh/mesh_io.h"
#include "core/model/shapes/shape_files.h"
#include "core/template/template.h"

namespace homolog {

// A study has one template: no model takes shapes of two together.

/// A shape of the template; true: of its mirror image. Points alone have no faces to tell by. Errors: a shape of
/// another numbering, on which the template's faces would be nonsense.
Result<bool> mirrors_template(const MeshFile& mesh, const std::filesystem::path& file, const Template& the_template);

/// Errors: the case's structure (by its id; empty: the first) is neither of the template nor of its mirror image. A
/// case that cannot be read, or has no mesh yet, says nothing.
Result<void> check_template_of_case(const std::filesystem::path& file, const std::string& structure,
                                    const Template& the_template, ReadTogether& together);

/// Errors: the study is there with cases of a template that has other faces than all of `templates` (null: none).
/// `of_them`: what they are called. `remedy`: what would help.
Result<void> check_template_of_study(const std::filesystem::path& study,
                                     const std::vector<std::shared_ptr<const Template>>& templates,
                                     const std::string& of_them, const std::string& remedy);

}  // namespace homolog
