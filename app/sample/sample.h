#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.h"

namespace homolog {

/// Writes the sample, whole, over what was there: a real heart (its image in one phase), an expert's label map, the
/// same heart's cine with label maps of end-diastole (frame 18) and end-systole (frame 7), and where they come from.
/// Makes the folder. Gives the paths in this order.
Result<std::vector<std::filesystem::path>> write_sample(const std::filesystem::path& folder);

/// The parts of the sample that the editor opens: files in a folder of the program's own, and the built-in ventricle.
struct OwnSample {
  std::filesystem::path image, labels;
  std::string template_source;
};
OwnSample own_sample();
/// Writes the sample there.
Result<void> write_own_sample();

}  // namespace homolog
