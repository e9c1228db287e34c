#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "app/verbs/verb.h"

namespace homolog {

/// How far a file is from the one that was made anew.
struct FileDifference {
  bool same_bytes = false;            ///< all are the same but for where other files lie that it names
  bool same_content = false;          ///< points, faces, modes or voxels are the same to the last bit
  std::optional<double> largest_mm;   ///< the largest distance of vertices, or of a model's mean and modes at one σ
  std::optional<std::size_t> voxels;  ///< how many differ
  std::string in_words;               ///< the difference in words, where no length says it; else empty
  std::optional<std::size_t> lines_since{};  ///< the number of a case's lines behind those of the verb that began it
};

/// Compares all that carries a record. A file that names other files may name them at other places, as long as they
/// hold the same. A case may have gone on: then its first lines count, and all are played, which has to give what its
/// checkpoints say. Errors: one of them cannot be read or played, cancelled.
Result<FileDifference> difference_of_files(const std::filesystem::path& file, const std::filesystem::path& anew,
                                           Progress& progress);

}  // namespace homolog
