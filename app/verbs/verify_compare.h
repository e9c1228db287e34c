#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "app/verbs/verb.h"

namespace homolog {

/// How far a file is from the one that was made anew.
struct FileDifference {
  bool same_bytes = false;
  bool same_content = false;          ///< points, faces, modes or voxels are the same to the last bit
  std::optional<double> largest_mm;   ///< of vertices, or of a model's mean and modes at one σ
  std::optional<std::size_t> voxels;  ///< how many differ
  std::string in_words;               ///< what differs, where no length says it; else empty
};

/// Of meshes, models and images. Errors: one of them cannot be read, cancelled.
Result<FileDifference> difference_of_files(const std::filesystem::path& file, const std::filesystem::path& anew,
                                           Progress& progress);

}  // namespace homolog
