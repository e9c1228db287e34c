#pragma once

#include <filesystem>
#include <string>

namespace homolog {

/// What is to be said of a file in one of FreeSurfer's own formats, which are not read: a surface (by its first bytes),
/// or a parcellation of one (`.annot`). The end of a sentence with the remedy; empty for any other file.
std::string freesurfer_words(const std::filesystem::path& path);

}  // namespace homolog
