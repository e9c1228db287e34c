#pragma once

#include <filesystem>
#include <string>

namespace homolog {

/// The name of a file or folder without what says its format: "ct" of "ct.nii.gz", "seg.01" of "seg.01.seg.nrrd". Only
/// endings of known formats are cut, in any case. Other dots stay, so "sub.01" and "sub.02" are two names.
std::string file_stem(const std::filesystem::path& path);

}  // namespace homolog
