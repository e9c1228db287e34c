#pragma once

#include <vector>

#include "core/mesh/topology.h"

namespace homolog {

/// Points of a surface, each with its normal and the area that it stands for. They ascend along one axis, so that those
/// near a place are found fast.
struct SurfaceSamples {
  Points points, normals;  ///< k×3, LPS mm; unit normals, outward
  Eigen::VectorXf area_mm2;
  Eigen::Index along = 0;              ///< the axis, 0 … 2
  std::vector<Eigen::Index> vertices;  ///< k: those of the mesh, in this order
};

/// These vertices of `mesh` as samples, sorted along the longest side of its box. `normals`: n×3, of all its vertices.
SurfaceSamples samples_of(const Mesh& mesh, const Points& normals, std::vector<Eigen::Index> vertices);

/// Up to `count` vertices spread evenly: each the farthest from those before, the first one first. So the first k are
/// spread evenly, too.
std::vector<Eigen::Index> spread_vertices(const Points& points, Eigen::Index count);

/// At most `count` vertices at equal steps of the numbering, and more than half as many where there are so many.
std::vector<Eigen::Index> stepped_vertices(Eigen::Index vertices, Eigen::Index count);

/// The normals (k×3, unit) without detail finer than about `size_mm`: each is the mean around its place, of what does
/// not face away from it.
Points smooth_normals(const SurfaceSamples& samples, double size_mm);

/// The places to which samples are drawn (k×3, mm), and how much each is believed (area of both directions, mm²).
struct DrawnSamples {
  Points targets;
  VertexScalars weights;
};

/// Each sample of `own` may be any of `there`, and each of `there` any of `own`, or none. The nearer they lie in terms
/// of `near_mm`, and the less their normals differ in terms of 1/`facing`, the likelier.
DrawnSamples drawn(const SurfaceSamples& own, const SurfaceSamples& there, double near_mm, double facing);

/// The places of a shape's samples on a surface, as far as their normals tell.
struct LocatedSamples {
  Points targets;       ///< k×3, mm
  VertexScalars known;  ///< 0: nowhere, the target is the place; 1: as in a plane; 10: to a third of `near_mm`
};

/// Each of `places` (k×3, mm) lies about `near_mm` from where it belongs on `there`, which faces as `normals` (k×3,
/// unit) does. The less normals differ in terms of 1/`facing`, the likelier. Each place is located for itself.
LocatedSamples located(const Points& places, const Points& normals, const SurfaceSamples& there, double near_mm,
                       double facing);

}  // namespace homolog
