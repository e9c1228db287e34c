#pragma once

#include <list>
#include <memory>
#include <vector>

#include "render/outline.h"

namespace homolog {

/// Outlines of meshes in planes; one that was asked for of late is not worked out again while its points live. For one
/// thread.
class Outlines {
 public:
  using Outline = std::shared_ptr<const std::vector<OutlineSegment>>;
  /// intersect_plane of the mesh. Points that are another object count as others.
  Outline of(const std::shared_ptr<const Topology>& topology, const std::shared_ptr<const Points>& points,
             const Vec3& on_plane, const Vec3& normal);

 private:
  struct Known {
    std::weak_ptr<const Topology> topology;
    std::weak_ptr<const Points> points;
    Vec3 on_plane, normal;
    Outline outline;
  };
  std::list<Known> known_;  ///< latest first
};

}  // namespace homolog
