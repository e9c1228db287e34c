#pragma once

#include <vector>

#include "core/mesh/topology.h"

namespace homolog {

/// Points of a surface, each with its normal and the area that it stands for. They ascend along one axis, so that those
/// near a place are found fast.
struct SurfaceSamples {
  Points points, normals;  ///< k×3, LPS mm; unit normals, outward
  Eigen::VectorXf area_mm2;
  Eigen::Index along = 0;  ///< the axis, 0 … 2
};

/// These vertices of `mesh` as samples, sorted along the longest side of its box. `normals`: n×3, of all its vertices.
SurfaceSamples samples_of(const Mesh& mesh, const Points& normals, std::vector<Eigen::Index> vertices);

/// Up to `count` vertices spread evenly: each the farthest from those before, the first one first. So the first k are
/// spread evenly, too.
std::vector<Eigen::Index> spread_vertices(const Points& points, Eigen::Index count);

/// At most `count` vertices at equal steps of the numbering, and more than half as many where there are so many.
std::vector<Eigen::Index> stepped_vertices(Eigen::Index vertices, Eigen::Index count);

/// Where samples are drawn to (k×3, mm), and how much each is believed (area of both directions, mm²).
struct DrawnSamples {
  Points targets;
  VertexScalars weights;
};

/// Each sample of `own` may be any of `there`, and each of `there` any of `own`, or none. The nearer they lie in terms
/// of `near_mm`, and the less their normals differ in terms of 1/`facing`, the likelier.
DrawnSamples drawn(const SurfaceSamples& own, const SurfaceSamples& there, double near_mm, double facing);

}  // namespace homolog
