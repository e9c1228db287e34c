#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/mesh/topology.h"

namespace homolog {

/// The faults that make a mesh a bad template, counted.
struct MeshFaults {
  std::size_t intersections = 0;  ///< pairs of faces that cut each other
  std::size_t turned = 0;         ///< faces that look against all faces around them
  std::size_t flat = 0;           ///< faces with an angle below 1°
  int tunnels = 0;                ///< genus
  bool all_intersections = true;  ///< false: at least so many; see SelfIntersections

  /// Whether meshes fitted with such a template must have faults too, or nobody knows.
  bool any() const { return intersections + turned + flat > 0 || !all_intersections; }
  /// More tunnels than organs have: the surface of a label map with noise, or of trabeculae.
  bool riddled() const { return tunnels > 16; }
  /// "3 pairs of faces that cut each other and 2 faces with an angle below 1°"; empty without any. Said, too, where so
  /// many faces lie close to each other that not all were compared.
  std::string words() const;
};

MeshFaults mesh_faults(const Mesh& mesh);

/// The faces that are counted there, in rising order: that cut others, are turned or flat.
std::vector<std::int32_t> faulty_faces(const Mesh& mesh);

/// Mends a mesh of few faulty faces (0.5 % at most, else it stays as it is), as where both sides of a wall meet that is
/// as thick as an edge is long: their vertices go towards the middle of their one-rings for some rounds, and the mesh
/// with the fewest faulty faces is kept. They leave the surface a little.
void smooth_faults(Mesh& mesh);

}  // namespace homolog
