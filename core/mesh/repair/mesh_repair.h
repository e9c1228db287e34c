#pragma once

#include <limits>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/mesh/mesh_io.h"
#include "core/mesh/topology.h"

namespace homolog {

/// The faults of a surface, counted. All of it was mended.
struct MendedFaults {
  std::size_t not_finite = 0;             ///< vertices with a coordinate that is no finite number: left out
  std::size_t duplicate_vertices = 0;     ///< vertices at (nearly) one place with another: made one
  std::size_t unused_vertices = 0;        ///< vertices of no face: left out
  std::size_t degenerate_faces = 0;       ///< faces without area: left out, or their longest edge was flipped
  std::size_t duplicate_faces = 0;        ///< faces with the same three corners as another: left out
  std::size_t non_manifold_edges = 0;     ///< edges of more than two faces: the sheets that met there were parted
  std::size_t non_manifold_vertices = 0;  ///< vertices at which alone sheets met: parted
  std::size_t turned_faces = 0;           ///< faces that looked against their neighbours, or inward: turned
  std::size_t crumbs = 0;                 ///< parts of next to no area: left out
  std::size_t cavities = 0;               ///< parts within another that look inward: filled
  std::size_t holes = 0;                  ///< closed flat

  bool any() const;
  /// "2 vertices that are no numbers left out and 3 holes closed"; empty without any.
  std::string words() const;
};

struct RepairOptions {
  /// Holes whose rim is longer stay open. A share of the diagonal of the surface's bounding box.
  double longest_rim_share = std::numeric_limits<double>::infinity();
};

/// The rim of a small hole, as a share of the diagonal: that of the open base of a ventricle is longer.
inline constexpr double small_rim_share = 0.5;

struct MeshRepair {
  Mesh mesh;  ///< manifold, consistently oriented, outward; its parts in the order of their first vertices
  MendedFaults mended;
};

/// The parts of a mesh that hang together, each as a mesh of its own, by first vertex.
std::vector<Mesh> parts_of(const Mesh& mesh);

/// The parts that may belong together, each group as one mesh: that with the most area and those whose bounding boxes
/// meet its own, then the same of the rest.
std::vector<Mesh> neighbouring_parts(const Mesh& mesh);

/// Several meshes as one, their vertices in turn.
Mesh joined(const std::vector<Mesh>& parts);

/// A manifold surface from whatever faces a file holds. Vertices within a millionth of the size are made one unless the
/// surface is sound as it is. If more than two faces meet at an edge, they are paired so that solids that only touch
/// there come apart [Gueziec 2001, Cutting and Stitching], by a hundredth of an edge. Parts of less than a hundredth of
/// the largest part's area are crumbs. A sound surface comes back with the same vertices in the same order. Tunnels
/// stay. Errors: no face is left, or no extent.
Result<MeshRepair> repaired(const MeshFile& surface, const RepairOptions& options = {});

/// The mesh as it is where it is sound; else mended, holes up to that share of its diagonal closed.
Result<MeshRepair> mended_if_broken(const MeshFile& surface, double longest_rim_share = small_rim_share);

}  // namespace homolog
