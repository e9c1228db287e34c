#pragma once

#include "core/adapt/force.h"
#include "core/mesh/topology.h"

namespace homolog {

/// The thing that a mesh is drawn to: a surface [surface_target.h], or the boundary that an image shows
/// [image_target.h]. Code that draws a mesh to a target knows no more of it than this.
class Target {
 public:
  virtual ~Target() = default;

  /// The places to which it draws the vertices of a mesh as it is now [Erdt 2009, Eq. 2]. `share`: of the way there, 0
  /// at the first step and 1 at the last; a target may look the nearer the larger it is.
  virtual TargetPull pull(const Mesh& mesh, double share) = 0;
  /// The place of the target to which each vertex belongs; the weight is the agreement.
  virtual TargetPull nearest(const Mesh& mesh) = 0;
  /// 0…1 of each vertex: how clearly the target says where it belongs.
  VertexScalars agreement(const Mesh& mesh) { return nearest(mesh).weights; }
  /// The length that distances off it are compared with, mm.
  virtual double size_mm() const = 0;
  /// From now on the target may lack parts of an organ of this size (its diagonal, mm).
  virtual void may_lack_parts(double /*organ_mm*/) {}

  /// How far it still pulls at the end of the way, squared, on average over vertices. Each counts as a small share of
  /// the size at most: a fold may hold some back, or show them a counterpart beyond, and they say nothing of the
  /// others.
  double off_mm2(const Mesh& mesh) {
    constexpr double most_counted_share = 0.03;
    const TargetPull left = pull(mesh, 1);
    const double most_mm = most_counted_share * size_mm();
    const VertexScalars away_mm2 = (left.targets - mesh.points).rowwise().squaredNorm().cwiseMin(most_mm * most_mm);
    return left.weights.dot(away_mm2) / static_cast<double>(mesh.points.rows());
  }
};

}  // namespace homolog
