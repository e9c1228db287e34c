#pragma once

#include <cstdint>
#include <filesystem>

#include "core/model/files/hdf_tree.h"

namespace homolog {

/// Reads a file with libhdf5 in this process. The library loops for ever or reads beyond its memory on some damaged
/// files. So only the child process that read_hdf5 starts may call this; everyone else calls read_hdf5.
Result<HdfTree> read_hdf5_unconfined(const std::filesystem::path& path, const HdfParts& parts);

/// How much of the processor's time that process may take for a file of `bytes` bytes: one second, and one for each
/// megabyte. A sound file of 20 kB takes 0.02 s, so that only one that loops for ever is given up.
unsigned most_reading_seconds(std::uintmax_t bytes);

}  // namespace homolog
