#pragma once

#include <filesystem>
#include <string>

#include "core/session/session.h"

namespace homolog {

/// Writes the case as far as it got to `path` (paths in its first line made relative to the new folder, every other
/// line as it is), and goes on there. Errors: Journal::create's.
Result<void> go_on_in(EditSession& session, const std::filesystem::path& path);

/// Names the label map that is shown over the image (empty: none) in the first line of the case's file, which is
/// written anew. Errors: go_on_in's; the file stays as it is then.
Result<void> name_labels(EditSession& session, const std::filesystem::path& labels);

/// Looks whether the path still holds the case's file as this program left it. If another program deleted, moved or
/// emptied it, all lines are written anew there. If another file is there, or its folder is gone, that is left
/// alone, and the case goes on as an unsaved one; where none can be made, in memory. Gives a sentence that says so;
/// empty where all is well.
std::string keep_case(EditSession& session);

}  // namespace homolog
