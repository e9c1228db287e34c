#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/mesh/geometry/surface_search.h"

namespace homolog {

/// A place of the mesh, and where the target has it.
struct Deviation {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  double distance_mm = 0;
  std::int32_t vertex = 0;  ///< nearest to `from`, of those around it
};

double mean_mm(const std::vector<Deviation>& deviations);
double mean_square_mm2(const std::vector<Deviation>& deviations);

/// The difference that a person sees between a mesh and a target, in both directions: mesh vertices off the target,
/// and points of the target that the mesh does not reach. Keeps its search trees from look to look.
class Sight {
 public:
  /// `target` is closed, as the surface of a label map is; an open mesh is looked at with its openings capped flat.
  Sight(const Mesh& target, std::shared_ptr<const Topology> topology);

  /// `points`: of the topology, LPS mm. Vertices in order, then points of the target in order.
  std::vector<Deviation> look(const Points& points);

  const Mesh& target() const { return target_.mesh(); }

 private:
  Points with_cap_centres(const Points& points) const;
  Deviation to_target(const Points& points, std::int32_t vertex);
  Deviation to_mesh(const Vec3& place, const Points& points, std::int32_t& likely_face) const;

  SurfaceSearch target_;
  std::shared_ptr<const Topology> topology_, capped_topology_;
  std::unique_ptr<SurfaceSearch> own_;  ///< the search on the capped mesh, refitted from look to look
  std::vector<Vec3> places_;            ///< places of the target that are looked at
  std::vector<std::int32_t> target_faces_, own_faces_;
};

}  // namespace homolog
