#pragma once

#include <memory>

#include "core/adapt/force.h"
#include "core/adapt/image/appearance.h"

namespace homolog {

/// On which side of its boundary the organ is brighter.
enum class Polarity {
  automatic,  ///< the side that has most of the edges around the mesh
  bright_inside,
  dark_inside,
  either
};

struct EdgeOptions {
  double reach_mm = 10;  ///< how far to both sides of the mesh the boundary is looked for
  Polarity polarity = Polarity::automatic;
  std::shared_ptr<const Appearance> appearance;  ///< the look of the boundary in cases done; null: edges are looked for
};

/// Looks along the normals of a mesh for the boundary that an image shows: a place where the contrast between inside
/// and outside is strong and the inside looks like the organ; or, after learning, a place that looks as in the finished
/// cases.
class EdgeSearch {
 public:
  /// `image` must outlive the search. `start`: the mesh at first; the usual contrast and the polarity are measured
  /// around it.
  EdgeSearch(const Volume& image, int frame, const Mesh& start, const EdgeOptions& options);

  /// For each vertex the likeliest boundary point within `reach_mm` along its normal. The weight is the confidence: 0
  /// beyond the scan and without an edge; low where an edge is weak, or away from those of the neighbours; 1 where it
  /// is as clear as usual.
  TargetPull find(const Mesh& mesh, double reach_mm) const;

  double reach_mm() const { return options_.reach_mm; }
  Polarity polarity() const { return options_.polarity; }
  bool learned() const { return options_.appearance != nullptr; }
  /// Whether the image shows anything like a boundary around the mesh that the search began with.
  bool sees_edges() const { return learned() || usual_contrast_ > 0; }

 private:
  Profiles profiles_of(const Mesh& mesh, double reach_mm) const;
  Eigen::MatrixXf contrasts(const Profiles& profiles) const;
  Eigen::MatrixXf edges(const Profiles& profiles) const;
  Eigen::MatrixXf scores(const Profiles& profiles, const Eigen::MatrixXf& edge, double reach_mm) const;
  float clearness(float height) const;
  void judge(const Mesh& start);

  const Volume& image_;
  int frame_;
  EdgeOptions options_;
  double step_mm_;
  Eigen::Index window_;  ///< samples to each side of an edge that are compared
  float usual_contrast_ = 0;
  float grain_ = 0;  ///< deviation that the image's noise alone gives a contrast
};

}  // namespace homolog
