#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/editor/state/open_request.h"
#include "core/base/result.h"

namespace homolog {

/// Sorts paths into a case, a volume, a template, by their names; two volumes are an image and its label map, and which
/// is which is seen when they are read. Contours are told by what is in the file. Errors: more than one of a kind, a
/// case with a template or two volumes.
Result<OpenRequest> sort_files(const std::vector<std::filesystem::path>& paths);

/// The sentence where a second volume cannot be the label map of the first.
Error second_image(const std::string& path, const std::string& why);

}  // namespace homolog
