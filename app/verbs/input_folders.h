#pragma once

#include <filesystem>
#include <vector>

#include "core/base/result.h"

namespace homolog {

/// For files and folders that are read late or one by one. Errors: one that a command line names is not there. An empty
/// name is none.
Result<void> check_there(const std::vector<std::filesystem::path>& named);

/// The volumes in a folder by name, as their endings say, else its DICOM segmentations [segmentations_in]; none where
/// the folder is one scan of slices.
std::vector<std::filesystem::path> volumes_in(const std::filesystem::path& folder);
/// The surfaces in a folder, by name.
std::vector<std::filesystem::path> surfaces_in(const std::filesystem::path& folder);

/// Files as they are; a folder stands for what `in` finds there, or for itself where that is nothing. `any`: whether
/// there was such a folder.
std::vector<std::filesystem::path> with_folders_opened(
    const std::vector<std::filesystem::path>& files,
    std::vector<std::filesystem::path> (*in)(const std::filesystem::path&), bool& any);

/// The label maps among volumes, which are read for it; a file that cannot be read stays, so that it is said.
std::vector<std::filesystem::path> label_maps_among(const std::vector<std::filesystem::path>& volumes);

}  // namespace homolog
