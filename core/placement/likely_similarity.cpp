#include "core/placement/likely_similarity.h"

#include <cmath>

#include "core/base/demand.h"
#include "core/base/numbers/rotation.h"

namespace homolog {

Similarity likely_similarity(const Points& from, const Points& to, const PlacementPrior& prior, double diagonal_mm) {
  demand(from.rows() == to.rows(), "there are other points to be carried than places for them; give as many of both");
  if (from.rows() == 0) return prior.around;
  const Vec3 from_centre = from.colwise().mean(), to_centre = to.colwise().mean();
  const Points a = from.rowwise() - from_centre.transpose(), b = to.rowwise() - to_centre.transpose();
  const Mat3 before = prior.around.rotation.toRotationMatrix();
  const double noise_mm = landmark_deviation_share * diagonal_mm * prior.around.scale;
  const Mat3 covariance = b.transpose() * a / (noise_mm * noise_mm);
  const double spread = a.squaredNorm() / (noise_mm * noise_mm);
  const double size_weight = std::pow(prior.around.scale * prior.size_deviation, -2);
  // Rotation and scale are each the best for the other; the scale only weighs landmarks against the prior.
  constexpr int rounds = 20;
  Mat3 rotation = before;
  double scale = prior.around.scale;
  for (int round = 0; round < rounds; ++round) {
    rotation = nearest_rotation(scale * covariance + prior.concentration() * before);
    scale = (rotation.cwiseProduct(covariance).sum() + prior.around.scale * size_weight) / (spread + size_weight);
  }
  return {Eigen::Quaterniond(rotation).normalized(), scale, to_centre - scale * (rotation * from_centre)};
}

}  // namespace homolog
