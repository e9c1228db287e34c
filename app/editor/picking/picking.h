#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/editor/state/drag.h"
#include "app/editor/state/layout.h"
#include "core/mesh/topology.h"
#include "render/renderer.h"

namespace homolog {

// The thing under the pointer, found on the CPU: the same with and without a GPU.

/// How a view maps mm to px of the window; for a slice or for the 3D view.
class ViewMap {
 public:
  ViewMap(const RectPx& rect, const SliceView& slice);
  ViewMap(const RectPx& rect, const Camera3D& camera);

  /// px of the window; nullopt behind the eye.
  std::optional<Eigen::Vector2d> to_px(const Vec3& p_mm) const;
  /// The point under a px on the plane through `on_plane` that faces the viewer (in a slice: on the slice).
  Vec3 on_facing_plane(double x_px, double y_px, const Vec3& on_plane) const;
  Ray ray(double x_px, double y_px) const;
  /// mm that one px covers at a point.
  double mm_per_px(const Vec3& at) const;
  /// Into the screen, unit.
  Vec3 into_screen() const;
  Vec3 right() const;
  const RectPx& rect() const { return rect_; }
  bool is_slice() const { return is_slice_; }
  const SliceView& slice() const { return slice_; }

 private:
  Viewport target() const;
  RectPx rect_;
  bool is_slice_;
  SliceView slice_;
  Camera3D camera_;
};

/// Whether the image on a slice plane hides a point that the ray meets.
bool hidden_by_planes(const std::vector<PlaneInSpace>& planes, const VolumeGeometry& image, const Ray& ray,
                      const Vec3& p_mm);

/// A ring around the mesh with a knob, in px of the window.
struct PlacementHandles {
  Eigen::Vector2d centre_px = Eigen::Vector2d::Zero(), knob_px = Eigen::Vector2d::Zero();
  double radius_px = 0;
  Vec3 centre_mm = Vec3::Zero();
};
std::optional<PlacementHandles> placement_handles(const ViewMap& map, const Points& points, float scale);
PlacePart part_at(const PlacementHandles& handles, double x_px, double y_px, float scale);
/// The placement to which a drag of a handle leads.
Similarity dragged_placement(const PlaceDrag& drag, const ViewMap& map, double x_px, double y_px);

/// Where the pointer is in a view.
struct Pointing {
  const ViewMap& map;  ///< outlives it
  double x_px, y_px;   ///< of the window
  float scale = 1;     ///< px of a unit of the interface
};

/// Name of the landmark drawn nearest to the pointer, within reach; slices offer those within `slice_reach_mm` of their
/// plane. Empty: there is none.
std::string landmark_at(const Pointing& at, const std::map<std::string, Vec3>& landmarks, double slice_reach_mm);

/// Whether a curve lies in the slice that a view shows, within half the distance of slices.
bool lies_in_slice(const ViewMap& map, const Contour& curve, const VolumeGeometry& geometry);

/// So near to a contour, in units of the interface, the pointer is at it.
inline constexpr double contour_reach_units = 14;
/// The contour of a structure that lies in the slice of a view nearest to the pointer, within reach, but for `hidden`
/// sets; none where none does.
std::optional<HeldContour> contour_at(const Pointing& pointing, const Document& document, const Structure& structure,
                                      const std::set<std::string>& hidden);

}  // namespace homolog
