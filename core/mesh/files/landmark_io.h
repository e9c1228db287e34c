#pragma once

#include <array>
#include <filesystem>
#include <string_view>
#include <vector>

#include "core/mesh/mesh_io.h"

namespace homolog {

/// The ends of landmark files' names; the first is looked for first.
inline constexpr std::array<std::string_view, 3> landmark_extensions{".mrk.json", ".fcsv", ".json"};

/// Whether the name is that of a landmark file.
inline bool is_landmark_name(const std::filesystem::path& path) {
  return path.extension() == ".json" || path.extension() == ".fcsv";
}

/// Reads named points from 3D Slicer's `.mrk.json` (control points of all its markups; RAS is turned to LPS, points not
/// yet placed are left out), from its older `.fcsv`, or from scalismo's JSON array of {`id`, `coordinates`}; which of
/// the two JSON files it is is told by the content. LPS mm. Errors: absent, of no such kind, a point without a name or
/// three finite coordinates, units other than mm, two points of one name.
Result<std::vector<Landmark>> read_landmarks(const std::filesystem::path& path);

/// Writes Slicer's form where the name ends in `.mrk.json` or `.fcsv`, scalismo's for any other `.json`; whole or not
/// at all. Other extensions are refused.
Result<void> write_landmarks(const std::vector<Landmark>& landmarks, const std::filesystem::path& path);

}  // namespace homolog
