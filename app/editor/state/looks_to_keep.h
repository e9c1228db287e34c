#pragma once

#include <filesystem>

#include "core/case/actions/kept_structures.h"

namespace homolog {

struct EditorState;

/// All that a case keeps of how it is looked at. `case_file`: of the case; files are named relative to its folder. A
/// file whose name is no UTF-8 is left out.
KeptLooks looks_to_keep(const EditorState& state, const std::filesystem::path& case_file);

}  // namespace homolog
