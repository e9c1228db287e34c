#pragma once

#include "core/volume/readers.h"

namespace homolog {

/// How text stands for voxels [NRRD format, "encoding"].
enum class VoxelText {
  Numbers,  ///< separated by blanks, line ends or commas
  Hex       ///< two digits a byte, in the file's byte order
};

/// Like read_run, of voxels that are written as text. Fails on what is no such text, on numbers that the type does not
/// hold, and where it ends early.
Result<StoredVoxels> read_text_voxels(const VoxelRun& run, VoxelText form, const VolumeGeometry& geometry,
                                      std::int64_t frames);

}  // namespace homolog
