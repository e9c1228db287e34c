#pragma once

#include <filesystem>
#include <vector>

#include "app/editor/state/open_request.h"
#include "core/base/result.h"

namespace homolog {

/// Writes the sample, whole, over what was there: a real heart (its image in one phase), an expert's label map, the
/// same heart's cine with label maps of end-diastole (frame 18) and end-systole (frame 7), and where they come from.
/// Makes the folder. Gives the paths in this order.
Result<std::vector<std::filesystem::path>> write_sample(const std::filesystem::path& folder);

/// Opens the sample with the built-in ventricle, from a folder of the program's own: the opener writes it there first
/// [make_sample].
OpenRequest sample_request();
/// Writes the sample where `request` asks for it; does nothing for all other requests.
Result<void> make_sample(const OpenRequest& request);

}  // namespace homolog
