#pragma once

#include <filesystem>

#include "core/model/hdf_tree.h"

namespace homolog {

/// What libhdf5 reads of a file, here in this process. The library loops for ever or reads beyond its memory on some
/// damaged files, so that all but the process that read_hdf5 starts call read_hdf5.
Result<HdfTree> read_hdf5_unconfined(const std::filesystem::path& path, const HdfParts& parts);

}  // namespace homolog
