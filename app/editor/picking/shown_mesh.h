#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "core/case/document.h"
#include "core/mesh/geometry/surface_search.h"
#include "render/outlines.h"
#include "render/renderer.h"

namespace homolog {

/// Answers questions about the mesh on the screen and caches the answers: its outline in each slice (for the pointer
/// and for drawing), and what a ray meets. Belongs to the window's thread.
class ShownMesh {
 public:
  /// The point of the mesh that is nearest to `p_mm` on the outline in a slice, where it is nearer than
  /// `radius_mm`.
  std::optional<Vec3> nearest_on_outline(const ShapeView& shown, const SliceView& slice, const Vec3& p_mm,
                                         double radius_mm) const;
  /// The first point of the mesh along a ray. The structure built to find it is kept for each structure.
  std::optional<Vec3> first_on_surface(const ShapeView& shown, const Ray& ray);
  /// Lets go of what was built for the rays of another case.
  void forget() { searched_.clear(); }

  /// Shared with the scenes that are drawn.
  const std::shared_ptr<Outlines>& outlines() const { return outlines_; }

 private:
  std::shared_ptr<Outlines> outlines_ = std::make_shared<Outlines>();
  struct Searched {
    std::shared_ptr<const Topology> topology;
    std::shared_ptr<const Points> points;
    Box box;                               ///< the box of `points`
    std::optional<SurfaceSearch> surface;  ///< made when a ray first meets the box
    bool follows = false;                  ///< `surface` is of `points`
  };
  std::map<std::string, Searched> searched_;  ///< by the structure's id
};

}  // namespace homolog
