#pragma once

#include <memory>

#include "core/base/processes/progress.h"
#include "core/mesh/files/volume_mesh.h"
#include "core/mesh/geometry/surface_search.h"

namespace homolog {

struct Springs;

/// A volume mesh in the shape of a case.
struct CarriedVolume {
  Points points;              ///< n×3, LPS mm
  double least = 0;           ///< scaled Jacobian [volume_mesh.h]
  Eigen::Index inverted = 0;  ///< tetrahedra that are turned over or flat
  Eigen::Index poor = 0;      ///< whose scaled Jacobian is below what is asked
  double slid_mm = 0;         ///< how far a point of the outside lies from where its place on the template belongs
  double lifted_mm = 0;       ///< the part of that across the surface
  bool sound() const { return poor == 0; }
};

/// Carries a volume mesh of a template into the cases that are in correspondence with it.
///
/// A point of its outside keeps its place on the template: the face, the weights in it, and how far off it lies, turned
/// and stretched as the face is. Points within lie where the elements are least distorted [volume_energy.h].
class VolumeCarrier {
 public:
  /// Errors: the outside lies off the template by more than a tenth of its diagonal, or the template off the outside,
  /// so it is another body's; its diagonal is another by more than a tenth, as that of a mesh in another unit is.
  static Result<VolumeCarrier> make(const VolumeMesh& mesh, const Mesh& the_template);

  /// `shape`: the template's vertices in the case, LPS mm. Errors: another number of vertices; a
  /// shape that is flat or mirrored; cancelled.
  Result<CarriedVolume> carry(const Points& shape, Progress* progress) const;

  double least() const { return least_; }  ///< scaled Jacobian of the mesh that was brought
  /// The least scaled Jacobian that a carried mesh is to have: 0.2, or 0.8 of the least of the mesh that was brought
  /// where that is less.
  double asked() const;
  double edge_mm() const;                    ///< how long an edge of a regular element of mean volume is
  double off_mm() const { return off_mm_; }  ///< how far a point of the outside lies from the template at most
  /// Whether that is more than meshers leave: above a hundredth of the template's diagonal.
  bool is_far_off() const { return far_off_; }

 private:
  struct Solver;
  struct Ground;
  VolumeCarrier() = default;
  void prepare();
  Points outside_in(const Points& shape) const;
  Points begin(const Points& outside) const;
  bool settle_within(const Points& rest, Points& points, Progress* progress) const;
  std::vector<char> around_poor(const VertexScalars& quality, int rings) const;
  Ground ground_of(const Points& shape, const Points& outside) const;
  Springs springs_for(const std::vector<char>& moves, const Ground& ground, const Points& points) const;
  bool mend_around(const std::vector<char>& moves, const VertexScalars& quality, const Points& rest,
                   const Ground& ground, int round, Points& points, Progress* progress) const;
  bool mend_poor(const Points& rest, const Points& shape, const Points& outside, Points& points,
                 Progress* progress) const;
  double lifted(const Points& shape, const Points& outside, const Points& points) const;

  VolumeMesh mesh_;
  Mesh template_;
  std::vector<char> outside_;               ///< whether each point lies on the outside
  std::vector<Eigen::Index> fixed_, free_;  ///< points on the outside (and those of no element), points within
  std::vector<SurfacePoint> places_;        ///< the places of the fixed ones
  double least_ = 0, off_mm_ = 0;
  bool far_off_ = false;
  std::shared_ptr<const Solver> solver_;
};

}  // namespace homolog
