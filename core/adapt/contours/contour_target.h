#pragma once

#include <vector>

#include "core/adapt/contours/contour_samples.h"
#include "core/adapt/target.h"
#include "core/mesh/geometry/surface_search.h"

namespace homolog {

/// The place where a piece of a curve meets a mesh: that of the mesh's section with the curve's plane that is nearest
/// and faces the same way. If the plane misses the mesh, and for a curve in no plane, the nearest place of the mesh.
struct ContourMeeting {
  std::size_t sample = 0;
  SurfacePoint on;
  Vec3 position = Vec3::Zero();  ///< the mesh's place there, LPS mm
  Vec3 normal = Vec3::Zero();    ///< the mesh's normal there, unit, outward
};

/// A place where a section of the mesh lies beyond a curve that the organ lies inside of.
struct BeyondLimit {
  SurfacePoint on;
  Vec3 position = Vec3::Zero(), limit = Vec3::Zero();  ///< on the mesh, and where the curve is, LPS mm
  double length_mm = 0;                                ///< length of the section
};

/// Curves in some planes as a target. Every piece of a curve pulls at the section of the mesh with its plane, and every
/// piece of the section is pulled to the curve. A curve that lies outside only pushes in what lies beyond it, and pulls
/// a little to where the boundary is likeliest. All else is left to the shape.
class ContourTarget : public Target {
 public:
  explicit ContourTarget(ContourSamples contours);

  TargetPull pull(const Mesh& mesh, double share) override;
  /// Gives where a curve pulls vertices to.
  TargetPull nearest(const Mesh& mesh) override { return pull(mesh, 1); }
  double size_mm() const override { return contours_.diagonal_mm(); }

  const ContourSamples& contours() const { return contours_; }
  std::vector<ContourMeeting> meetings(const Mesh& mesh) const;
  std::vector<BeyondLimit> beyond(const Mesh& mesh) const;
  /// How far each piece lies from the mesh, mm: of a curve that lies outside how far the mesh reaches beyond it.
  VertexScalars off_pieces_mm(const Mesh& mesh) const;

 private:
  ContourSamples contours_;
};

}  // namespace homolog
