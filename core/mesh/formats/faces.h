#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/mesh_io.h"

/// Gathering the parts of a mesh while a file is read.
namespace homolog::formats {

/// A face of more corners is refused while it is read: no surface has one, and it would take much memory.
inline constexpr std::size_t most_corners = 1'000'000;
/// The refusal of such a face.
Result<void> too_many_corners();

/// The faces of a file, cut into triangles: a polygon of n corners gives n − 2.
class Faces {
 public:
  /// Errors: fewer than three corners, an impossible index.
  Result<void> add(std::span<const std::int64_t> polygon);

  /// How VTK's formats store many polygons: cell c has the vertices connectivity[ends[c − 1] … ends[c]). `strips`: each
  /// cell is a triangle strip, whose degenerate triangles are left out.
  Result<void> add_cells(std::span<const std::int64_t> ends, std::span<const std::int64_t> connectivity, bool strips);

  std::size_t triangles() const { return corners_.size() / 3; }

  /// Gives the mesh its points, three coordinates each, and these faces; both are given up, so that a large mesh is not
  /// held twice. A polygon is a fan around its first corner where that lies within it, else it is cut within its
  /// outline [polygons.h]. Errors: a polygon of so many corners that this would take long.
  Result<void> fill(MeshFile& mesh, std::vector<double> coordinates) &&;

 private:
  struct Polygon {
    std::size_t start = 0, count = 0;  ///< its corners in `corners_`: of the triangles of its fan
  };
  std::vector<std::int32_t> corners_;
  std::vector<Polygon> polygons_;  ///< those with more than three corners
};

/// The numbers as a matrix of points.
Points to_points(std::vector<double> coordinates);

}  // namespace homolog::formats
