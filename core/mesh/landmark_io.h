#pragma once

#include <filesystem>
#include <vector>

#include "core/mesh/mesh_io.h"

namespace homolog {

/// Whether the name is that of a landmark file (.mrk.json, .json).
inline bool is_landmark_name(const std::filesystem::path& path) {
  return path.extension() == ".json";
}

/// Reads named points from 3D Slicer's `.mrk.json` (control points of all its markups; RAS is turned to LPS, points not
/// yet placed are left out) or from scalismo's JSON array of {`id`, `coordinates`}; which of the two is told by the
/// content. LPS mm. Errors: absent, no JSON, neither of the two, a point without a name or three finite coordinates,
/// units other than mm, two points of one name.
Result<std::vector<Landmark>> read_landmarks(const std::filesystem::path& path);

/// Writes Slicer's form where the name ends in `.mrk.json`, scalismo's for any other `.json`; whole or not at all.
/// Other extensions are refused.
Result<void> write_landmarks(const std::vector<Landmark>& landmarks, const std::filesystem::path& path);

}  // namespace homolog
