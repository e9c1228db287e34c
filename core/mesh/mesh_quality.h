#pragma once

#include <array>
#include <limits>
#include <vector>

#include "core/mesh/topology.h"

namespace homolog {

/// Figures of one shape, as `homolog info` prints them. Lengths in mm, angles in degrees.
struct MeshQuality {
  double edge_mean = 0, edge_min = 0, edge_max = 0;
  double edge_cv = 0;  ///< standard deviation / mean of the edge lengths
  double min_angle_deg = 0;
  int valence_min = 0, valence_max = 0;
  double regular_share = 0;            ///< share of the vertices with six neighbours
  std::size_t self_intersections = 0;  ///< pairs of faces
  bool all_intersections = true;       ///< false: at least so many; see SelfIntersections
  double volume_ml = 0;                ///< enclosed volume, boundary loops capped flat
  double area_mm2 = 0;
};

MeshQuality mesh_quality(const Mesh& mesh);

/// A face's outward normal, as long as twice the face's area in mm².
Vec3 area_normal(const Mesh& mesh, Eigen::Index face);

/// The smallest of a face's three angles.
double smallest_angle_deg(const Mesh& mesh, Eigen::Index face);

/// The search stops at so many pairs: nobody would look at more.
inline constexpr std::size_t most_intersections = 100'000;

/// Pairs of faces that share no vertex and intersect, or that share a vertex (or an edge) and intersect beyond it.
struct SelfIntersections {
  std::vector<std::array<std::int32_t, 2>> pairs;  ///< each pair and all of them in rising order
  bool all = true;                                 ///< false: the search ended early; see find_self_intersections
};

/// Ends early where there are more than `most_intersections`, or where so many faces lie about one another that looking
/// at all pairs would take long.
SelfIntersections find_self_intersections(const Mesh& mesh);

/// Returns the pairs of find_self_intersections alone.
std::vector<std::array<std::int32_t, 2>> self_intersections(const Mesh& mesh);

/// Unit area-weighted vertex normals, n×3, pointing outward; zero at a vertex whose faces are all degenerate.
Points vertex_normals(const Mesh& mesh);

/// The area that each vertex stands for, mm²: a third of its faces.
VertexScalars vertex_areas_mm2(const Mesh& mesh);

/// Returns the part with the most area of those that hang together, its vertices renumbered in their order.
Mesh largest_part(const Mesh& mesh);

/// Area of all faces in mm².
double surface_area_mm2(const Mesh& mesh);

/// Enclosed volume in ml, each boundary loop capped flat (fan around its centroid); negative where faces look inward.
double enclosed_volume_ml(const Mesh& mesh);

/// The same shape with every boundary loop of at most `longest_mm` closed by a fan around the loop's centroid (one new
/// vertex a loop, appended).
Mesh capped(const Mesh& mesh, double longest_mm = std::numeric_limits<double>::infinity());

/// Mean edge length in mm.
double mean_edge_mm(const Topology& topology, const Points& points);

/// The quality of one triangle, 4√3·area / Σ edge²: 1 where it is equilateral, 0 where it is degenerate.
double triangle_quality(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace homolog
