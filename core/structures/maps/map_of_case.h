#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/case/actions/kept_structures.h"
#include "core/case/document.h"
#include "core/volume/volume_io.h"

namespace homolog {

/// How two label maps of the same layers and grids differ, as runs of five numbers each: the layer, the first voxel in
/// its data, how many there are, their label in `before` and in `after`.
std::vector<std::uint32_t> voxel_changes(const VolumeRead& before, const VolumeRead& after);

/// The structures that map_of_case draws by their meshes: those that were changed since the fit, or that it did not
/// find.
std::vector<std::string> drawn_by_mesh(const Document& document, const KeptMapFit& fit);

/// The label map that a case's structures were fitted to, as the case has it now in the frame of the fit: with what its
/// repair proposes, but for structures that somebody took back. A structure whose mesh was changed since, or that the
/// fit did not find, has the voxels within its mesh; where such a voxel has another label, it changes only where the
/// mesh of that label's structure leaves it. All other voxels stay. Labels are called as the structures are, and one
/// that was renamed has the value of its new name, where the map knows it. `map`: as it was read. `fit`: of that map.
/// Errors: another map than that of the fit, two labels with one name, a value that the map's type cannot hold,
/// cancelled.
Result<VolumeRead> map_of_case(const Document& document, VolumeRead map, const KeptMapFit& fit, Progress& progress);

}  // namespace homolog
