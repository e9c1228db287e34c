#include "core/placement/relative_pose.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/placement/similarity_fit.h"

namespace homolog {

namespace {

constexpr double degrees = 180 / std::numbers::pi;

/// The similarity of a subject: from the mean places to where its structures lie. None: it has no structure.
std::optional<Similarity> similarity_of_subject(const std::vector<Points>& templates,
                                                const std::vector<Similarity>& places,
                                                const std::vector<std::optional<Similarity>>& placed,
                                                const Similarity& current) {
  Eigen::Index rows = 0;
  for (std::size_t k = 0; k < templates.size(); ++k)
    if (placed[k]) rows += templates[k].rows();
  if (rows == 0) return std::nullopt;
  Points from(rows, 3), to(rows, 3);
  rows = 0;
  for (std::size_t k = 0; k < templates.size(); ++k) {
    if (!placed[k]) continue;
    from.middleRows(rows, templates[k].rows()) = places[k].apply(templates[k]);
    to.middleRows(rows, templates[k].rows()) = placed[k]->apply(templates[k]);
    rows += templates[k].rows();
  }
  return nearest_similarity(from, to, current);
}

}  // namespace

Vec3 turn_deg_of(const Eigen::Quaterniond& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * degrees * turn.axis();
}

Similarity mean_similarity(const std::vector<Similarity>& of, const Vec3& middle) {
  Eigen::Matrix4d products = Eigen::Matrix4d::Zero();
  double log_scale = 0;
  Vec3 there = Vec3::Zero();
  for (const Similarity& one : of) {
    products += one.rotation.coeffs() * one.rotation.coeffs().transpose();
    log_scale += std::log(one.scale);
    there += one.apply(middle);
  }
  const double count = static_cast<double>(of.size());
  Similarity mean;
  mean.rotation.coeffs() = Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(products).eigenvectors().col(3);
  if (mean.rotation.w() < 0) mean.rotation.coeffs() *= -1;
  mean.scale = std::exp(log_scale / count);
  mean.translation = there / count - mean.scale * (mean.rotation * middle);
  return mean;
}

RelativePose relative_pose(const std::vector<Similarity>& relative, const Vec3& middle) {
  const Similarity mean = mean_similarity(relative, middle);
  RelativePose pose;
  pose.subjects = relative.size();
  pose.offset_mm = mean.apply(middle) - middle;
  pose.turn_deg = turn_deg_of(mean.rotation);
  pose.scale = mean.scale;
  if (relative.size() < 2) return pose;
  double offset = 0, turn = 0, scale = 0;
  for (const Similarity& one : relative) {
    offset += (one.apply(middle) - mean.apply(middle)).squaredNorm();
    turn += std::pow(degrees * one.rotation.angularDistance(mean.rotation), 2);
    scale += std::pow(one.scale - mean.scale, 2);
  }
  const double free = static_cast<double>(relative.size() - 1);
  pose.offset_sd_mm = std::sqrt(offset / free);
  pose.turn_sd_deg = std::sqrt(turn / free);
  pose.scale_sd = std::sqrt(scale / free);
  return pose;
}

std::vector<Similarity> mean_places(const std::vector<Points>& templates,
                                    const std::vector<std::vector<std::optional<Similarity>>>& placed) {
  constexpr int most_rounds = 100;
  constexpr double at_rest_mm = 1e-7;
  std::vector<Similarity> places(templates.size()), of_subject(placed.size());
  std::vector<Vec3> middles;
  Vec3 middle = Vec3::Zero();
  for (const Points& points : templates) {
    middles.emplace_back(points.colwise().mean().transpose());
    middle += middles.back() / static_cast<double>(templates.size());
  }
  for (int round = 0; round < most_rounds; ++round) {
    std::vector<Similarity> there;
    for (std::size_t s = 0; s < placed.size(); ++s)
      if (const auto found = similarity_of_subject(templates, places, placed[s], of_subject[s])) {
        of_subject[s] = *found;
        there.push_back(*found);
      }
    if (there.empty()) break;
    const Similarity upright = mean_similarity(there, middle);
    double moved_mm = 0;
    for (std::size_t k = 0; k < templates.size(); ++k) {
      std::vector<Similarity> seen;
      for (std::size_t s = 0; s < placed.size(); ++s)
        if (placed[s][k]) seen.push_back(of_subject[s].inverse().after(*placed[s][k]));
      if (seen.empty()) continue;
      const Similarity place = upright.after(mean_similarity(seen, middles[k]));
      moved_mm = std::max(moved_mm, (place.apply(templates[k]) - places[k].apply(templates[k])).cwiseAbs().maxCoeff());
      places[k] = place;
    }
    if (moved_mm < at_rest_mm) break;
  }
  return places;
}

}  // namespace homolog
