#pragma once

#include <ostream>
#include <sstream>
#include <string>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/volume/volume.h"

/// The parts that the writers behind write_volume share. Headers of images are a dozen lines each; writing them through
/// streams, unlike through the libraries, tells of a full disk.
namespace homolog {

/// The voxels as they lie in memory. Errors: cancelled.
Result<void> write_plain(std::ostream& out, const VoxelData& data, Progress* progress);

/// `begin` and the voxels as one gzip stream. Errors: cancelled.
Result<void> write_compressed(std::ostream& out, const std::string& begin, const VoxelData& data, Progress* progress);

/// For a header: numbers are written the same in every locale and read again without loss.
std::ostringstream exact_text();

}  // namespace homolog
