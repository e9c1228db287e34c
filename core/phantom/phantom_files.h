#pragma once

#include <filesystem>
#include <vector>

#include "core/phantom/phantom.h"
#include "core/phantom/phantom_scene.h"

namespace homolog {

/// Writes subject `number` of an organ into `folder` (made where absent), every name starting with ORGAN-NUMBER:
/// `-image.nii.gz`, `-labels.nii.gz`, `-truth.ply` (a cine: `-truth-00.ply`, one a frame) and `-landmarks.mrk.json`.
/// Gives the paths in this order. Errors: the folder cannot be made or written to.
Result<std::vector<std::filesystem::path>> write_phantom(Organ organ, int number, const std::filesystem::path& folder);

/// Writes subject `number` of the spine into `folder`, every name starting with spine-NUMBER: `-image.nii.gz`,
/// `-labels.nii.gz` with the names in `-labels.json` beside it, `-truth/NAME.ply` for each structure, and
/// `-landmarks.mrk.json` of all of them. Gives the paths in this order. Errors: as above.
Result<std::vector<std::filesystem::path>> write_spine_phantom(int number, const std::filesystem::path& folder);

}  // namespace homolog
