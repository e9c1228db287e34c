#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <vector>

#include "core/groupwise/surface_features.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/topology.h"
#include "core/solve/shape_solver.h"

namespace homolog {

/// The places where the vertices of a shape ought to be, as other shapes have it.
struct ExpectedShape {
  Points points;             ///< n×3, in the shape's own frame, mm
  SurfaceFeatures features;  ///< n×6, in the units of the shape's own
  double per_mm = 0;         ///< the weight of a mm beside `points`, where a unit of a feature counts 1
};

/// A mesh whose vertices slide along the surface that it has at first. In both directions the surface stays within a
/// tenth of the mean edge. Held vertices and those of a rim stay exactly. No triangle turns, and none gets flat.
class SlidingSurface {
 public:
  /// `start`: n×3, mm. `features`: of its vertices, each column in units of its own spread. `held`: 0 for free
  /// vertices; empty for none held. `solver` is factorised with the hold of this mesh, so that Eq. 3 spreads a slide.
  SlidingSurface(std::shared_ptr<const Topology> topology, Points start, SurfaceFeatures features, VertexScalars held,
                 std::shared_ptr<const ShapeSolver> solver);

  const Points& points() const { return points_; }
  /// The features of the places where the vertices lie now.
  SurfaceFeatures features() const;
  /// How far each vertex lies from where it was at first, n values in mm.
  VertexScalars slides_mm() const { return (points_ - start_).rowwise().norm(); }

  /// A step of `share` towards what is expected: each vertex is drawn along the surface to the place that agrees best,
  /// by Gauss and Newton, and Eq. 3 spreads the draw, its reference the mesh at first turned with the shape. Gives the
  /// root mean square of the way in mm; 0 where no step can be taken.
  double slide(const ExpectedShape& expected, double share);

 private:
  /// Vertices moved along the surface, and what they lie on.
  struct Place {
    Points points;
    std::vector<SurfacePoint> at;       ///< each vertex's place on the surface at first
    std::vector<SurfacePoint> covered;  ///< the place on the mesh of each vertex of the surface at first
  };
  Points drawn(const ExpectedShape& expected) const;
  /// Moves these vertices by `offset` from where they are, along the surface.
  void move(const Points& offset, const std::set<std::int32_t>& vertices, Place& place) const;
  /// The vertices around what must not be: turned or flat triangles, and places where the surface moved. Only what
  /// `moved` can have changed is looked at.
  std::set<std::int32_t> faulty_vertices(const std::set<std::int32_t>& moved, Place& place) const;

  std::shared_ptr<const Topology> topology_;
  Points start_, points_;
  SurfaceFeatures features_;                            ///< features of the surface at first
  std::vector<Eigen::Matrix<double, 3, 6>> gradients_;  ///< their gradients, a mm
  VertexScalars held_;
  std::shared_ptr<const ShapeSolver> solver_;
  std::vector<SurfacePoint> at_, covered_;
  VertexScalars least_quality_;  ///< the least quality of each triangle
  double edge_mm_;
};

}  // namespace homolog
