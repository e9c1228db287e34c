#pragma once

#include <vector>

#include "core/adapt/annealing.h"
#include "core/adapt/image/edge_search.h"
#include "core/adapt/target.h"

namespace homolog {

/// The boundary that an image shows, as a target. It is looked for along the normals, the nearer the more of the way is
/// done. An edge that stands alone among vertices without one counts little.
class ImageTarget : public Target {
 public:
  /// `image` must outlive the target. `start`: the mesh at first. `pins`: places of the surface that are known; edges
  /// far off the mesh count less near them.
  ImageTarget(const Volume& image, int frame, const Mesh& start, const EdgeOptions& options,
              std::vector<Pin> pins = {});

  /// Whether the image shows anything like a boundary around the mesh at first.
  bool is_there() const { return edges_.sees_edges(); }
  /// Whether it goes by what the boundary looks like in cases that are done.
  bool is_learned() const { return edges_.learned(); }

  TargetPull pull(const Mesh& mesh, double share) override;
  /// The same where also what stands alone counts in full.
  TargetPull likeliest(const Mesh& mesh, double share) const { return edges_.find(mesh, reach_mm(share)); }
  /// The weight is the confidence: how clear the edge is.
  TargetPull nearest(const Mesh& mesh) override;
  /// The root of the area of the mesh at first.
  double size_mm() const override { return size_mm_; }

 private:
  double reach_mm(double share) const;

  EdgeSearch edges_;
  std::vector<Pin> pins_;
  double size_mm_;
};

}  // namespace homolog
