#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh/formats/faces.h"
#include "core/mesh/formats/space.h"
#include "core/mesh/mesh_io.h"

/// Files that hold elements of several kinds: VTU and MSH.
namespace homolog::formats {

/// The place in a file of the coordinates of some of its points.
struct PointsPlace {
  std::size_t at = 0, length = 0;     ///< bytes
  Eigen::Index first = 0, count = 0;  ///< points
};
/// How they are written there: as the node <Points> of VTK's XML, as text, or as numbers of double precision.
enum class PointsForm { vtk_xml, text, little_endian, big_endian };

/// The content of such a file, as it stands there.
struct VolumeCells {
  std::vector<double> coordinates;
  Faces faces;
  std::vector<std::int32_t> tetrahedra;  ///< four corners each
  std::map<std::string, VertexScalars> arrays;
  SpaceNames space;
  std::vector<std::string> warnings;
  std::string likely_cause;  ///< MeshFile::likely_cause
  std::size_t vectors = 0;   ///< arrays of three or nine values, which may be directions
  std::vector<PointsPlace> places;
  PointsForm form = PointsForm::text;
};

/// Each takes the bytes of a whole file. Errors name no file: damaged, elements that are neither triangles, polygons
/// nor tetrahedra. Lines and single points are passed over. `with_places`: also where coordinates lie; of a text file
/// that is much memory.
Result<VolumeCells> vtu_cells(std::string_view bytes);
Result<VolumeCells> msh_cells(std::string_view bytes, bool with_places);

/// Adds a tetrahedron. Errors: an impossible index.
Result<void> add_tetrahedron(const std::int64_t* corners, VolumeCells& cells);
/// The refusal of elements that have no place in a mesh of triangles or tetrahedra. `kind`: "hexahedra" and so on.
Error unsuited_elements(const std::string& kind);

/// Errors: a tetrahedron that names a point twice.
Result<void> check_corners(const std::vector<std::int32_t>& tetrahedra);

/// Keeps one of the tetrahedra with the same four corners, the first: Gmsh lists an element once for each of its
/// groups. A warning says how many there were.
void drop_repeated(std::vector<std::int32_t>& tetrahedra, std::vector<std::string>& warnings);
/// The triangles of a file; where it holds tetrahedra, their outside. The points within tetrahedra are left out, which
/// a warning says.
Result<MeshFile> surface_of(VolumeCells cells);

/// The faces of tetrahedra that belong to one of them alone, seen from outside, as indices of points. `corners`: four a
/// tetrahedron, any orientation, none of them twice. Errors: none; a face of three tetrahedra counts as inner.
std::vector<std::int32_t> outer_faces(const std::vector<std::int32_t>& corners, const std::vector<double>& coordinates);

}  // namespace homolog::formats
