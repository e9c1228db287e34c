#pragma once

#include <filesystem>
#include <string>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/volume/volume.h"

namespace homolog {

/// Writes a volume as NIfTI-1, or as NIfTI-2 where that does not hold its size or its place. The format keeps no
/// record.
Result<void> write_nifti(const Volume& volume, const std::filesystem::path& path, const std::string& record,
                         Progress* progress);

}  // namespace homolog
