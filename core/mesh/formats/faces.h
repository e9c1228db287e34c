#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/mesh/mesh_io.h"

/// Gathering the parts of a mesh while a file is read.
namespace homolog::formats {

/// Appends a polygon as a fan of triangles to `corners`. Errors: fewer than three corners, an impossible index.
Result<void> add_polygon(std::span<const std::int64_t> polygon, std::vector<std::int32_t>& corners);

/// How VTK's formats store many polygons: cell c has the vertices connectivity[ends[c − 1] … ends[c]). `strips`: each
/// cell is a triangle strip, whose degenerate triangles are left out.
Result<void> add_cells(std::span<const std::int64_t> ends, std::span<const std::int64_t> connectivity, bool strips,
                       std::vector<std::int32_t>& corners);

/// The numbers as a matrix; they are given up, so that a large mesh is not held twice.
Points to_points(std::vector<double> coordinates);
Triangles to_triangles(std::vector<std::int32_t> corners);

/// Turns a mesh read in RAS into LPS where `text` says SPACE=RAS.
void flip_if_ras(std::string_view text, MeshFile& mesh);

}  // namespace homolog::formats
