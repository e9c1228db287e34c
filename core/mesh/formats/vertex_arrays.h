#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/mesh/mesh_io.h"

/// The values that a mesh has for each vertex, as VTK's point data: `stiffness`, `doubt_mm`, `outlier` and `region`,
/// which a PLY file has under the same names.
namespace homolog::formats {

/// Those that a mesh has, in that order. A region is its index, from 1; 0: none.
std::vector<std::pair<std::string, VertexScalars>> vertex_arrays(const MeshFile& mesh);

/// Keeps an array that was read; one of another name goes into `arrays`. `region` needs regions, of which the file
/// tells names, factors and colours nothing: they are made of the indices. Only lengths that fit, and finite numbers,
/// are kept; of the names above a warning says what was not.
void keep_vertex_array(std::string_view name, VertexScalars values, MeshFile& mesh);

/// The warning that the values of a name are damaged and were not taken.
std::string left_out(std::string_view name);

}  // namespace homolog::formats
