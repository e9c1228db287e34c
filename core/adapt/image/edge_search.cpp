#include "core/adapt/image/edge_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/adapt/image/tissue.h"
#include "core/base/numbers/statistics.h"
#include "core/base/processes/parallel.h"

namespace homolog {

namespace {

constexpr double window_voxels = 1.5;                ///< to each side of an edge
constexpr float deviation_from_median = 1.48f;       ///< for a normal distribution's absolute values
constexpr float least_grains = 1, clear_grains = 3;  ///< contrast of no and of full confidence, in the noise's
constexpr double usual_share = 0.6;                  ///< so many of the vertices have a weaker edge than the usual one
constexpr double clear_majority = 1.5;               ///< one polarity's energy over the other's
constexpr float misplaced_per_mm = 0.3f;             ///< cost of a mm of foreign tissue on one side, in usual edges
constexpr float farthest_cost = 0.3f;                ///< cost of an edge at the end of the reach, in usual edges
constexpr float least_likeness = 0.3f, full_likeness = 0.9f;  ///< likeness of no and of full confidence
constexpr double agreeing_share = 0.25;  ///< share of the reach that the edges of neighbours may differ by
constexpr double least_agreeing_mm = 1;

/// A local maximum of a column, in samples from its middle.
struct EdgePeak {
  double at = 0;
  float height = 0;
};

/// The best by `score` of the maxima of `edge` within `reach` samples of the middle.
std::optional<EdgePeak> best_peak(const Eigen::Ref<const Eigen::VectorXf>& edge,
                                  const Eigen::Ref<const Eigen::VectorXf>& score, Eigen::Index reach) {
  const Eigen::Index middle = edge.size() / 2;
  std::optional<Eigen::Index> best;
  for (Eigen::Index k = std::max<Eigen::Index>(1, middle - reach); k <= std::min(middle + reach, edge.size() - 2); ++k)
    if (edge[k] > 0 && edge[k] >= edge[k - 1] && edge[k] >= edge[k + 1] && (!best || score[k] > score[*best])) best = k;
  if (!best) return std::nullopt;
  const double before = edge[*best - 1], at = edge[*best], after = edge[*best + 1];
  const double bend = before - 2 * at + after;
  const double part = bend < 0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0;
  return EdgePeak{static_cast<double>(*best - middle) + part, edge[*best]};
}

/// How well each vertex's shift agrees with those of its neighbours, 0…1: noise has no edges side by side.
VertexScalars neighbours_agreement(const Topology& topology, const VertexScalars& shift_mm,
                                   const VertexScalars& weights, double tolerance_mm) {
  VertexScalars agrees = VertexScalars::Zero(shift_mm.size());
  for (Eigen::Index i = 0; i < shift_mm.size(); ++i) {
    double sum = 0, weight = 0;
    for (const std::int32_t j : topology.one_ring(i)) {
      sum += weights[j] * shift_mm[j];
      weight += weights[j];
    }
    if (weight <= 0) continue;
    const double off = (shift_mm[i] - sum / weight) / tolerance_mm;
    agrees[i] = std::exp(-0.5 * off * off);
  }
  return agrees;
}

}  // namespace

EdgeSearch::EdgeSearch(const Volume& image, int frame, const Mesh& start, const EdgeOptions& options)
    : image_(image),
      frame_(frame),
      options_(options),
      step_mm_(profile_step_mm(image)),
      window_(std::max<Eigen::Index>(1, std::lround(2 * window_voxels))) {
  if (!learned()) judge(start);
}

/// Polarity and strength of the edges around the mesh, and the noise between them.
void EdgeSearch::judge(const Mesh& start) {
  const Profiles rough = sample_profiles(image_, frame_, start, options_.reach_mm, step_mm_);
  const Eigen::MatrixXf contrast = contrasts(smoothed_over_surface(*start.topology, rough));
  const Eigen::MatrixXf single = contrasts(rough);
  std::vector<float> grain;
  for (Eigen::Index k = 0; k < single.size(); ++k)
    if (const float off = single.data()[k] - contrast.data()[k]; std::isfinite(off)) grain.push_back(std::abs(off));
  grain_ = deviation_from_median * quantile(std::move(grain), 0.5);
  std::vector<float> bright, dark;
  double bright_energy = 0, dark_energy = 0;
  for (Eigen::Index i = 0; i < contrast.cols(); ++i) {
    const auto known = contrast.col(i).array().isFinite();
    const float most = known.select(contrast.col(i).array(), 0.0f).maxCoeff();
    const float least = known.select(contrast.col(i).array(), 0.0f).minCoeff();
    bright.push_back(std::max(most, 0.0f));
    dark.push_back(std::max(-least, 0.0f));
    bright_energy += static_cast<double>(bright.back()) * bright.back();
    dark_energy += static_cast<double>(dark.back()) * dark.back();
  }
  Polarity& polarity = options_.polarity;
  if (polarity == Polarity::automatic) {
    polarity = bright_energy > clear_majority * dark_energy   ? Polarity::bright_inside
               : dark_energy > clear_majority * bright_energy ? Polarity::dark_inside
                                                              : Polarity::either;
  }
  if (polarity == Polarity::either)
    std::transform(bright.begin(), bright.end(), dark.begin(), bright.begin(),
                   [](float a, float b) { return std::max(a, b); });
  usual_contrast_ = quantile(polarity == Polarity::dark_inside ? dark : bright, usual_share);
}

Profiles EdgeSearch::profiles_of(const Mesh& mesh, double reach_mm) const {
  const double compared_mm = learned() ? Appearance::reach_mm() : static_cast<double>(window_) * step_mm_;
  return smoothed_over_surface(*mesh.topology,
                               sample_profiles(image_, frame_, mesh, reach_mm + compared_mm + step_mm_, step_mm_));
}

/// Mean within minus mean without at every sample; NaN where the scan shows too little.
Eigen::MatrixXf EdgeSearch::contrasts(const Profiles& profiles) const {
  const Eigen::MatrixXf& values = profiles.values;
  Eigen::MatrixXf result = Eigen::MatrixXf::Constant(values.rows(), values.cols(), not_shown);
  in_parallel(values.cols(), [&](Eigen::Index from, Eigen::Index to) {
    for (Eigen::Index i = from; i < to; ++i)
      for (Eigen::Index k = window_; k + window_ < values.rows(); ++k)
        result(k, i) =
            values.col(i).segment(k - window_, window_).mean() - values.col(i).segment(k + 1, window_).mean();
  });
  return result;
}

/// How much each sample looks like a boundary: after learning its likeness, else its contrast as a multiple of the
/// usual one.
Eigen::MatrixXf EdgeSearch::edges(const Profiles& profiles) const {
  if (learned()) return options_.appearance->likeness(profiles);
  const Eigen::MatrixXf contrast = contrasts(profiles) / usual_contrast_;
  if (polarity() == Polarity::dark_inside) return -contrast;
  return polarity() == Polarity::either ? contrast.cwiseAbs() : contrast;
}

/// Weighs the edges of one profile against each other: less where foreign tissue lies inside or organ tissue outside,
/// and less far away.
Eigen::MatrixXf EdgeSearch::scores(const Profiles& profiles, const Eigen::MatrixXf& edge, double reach_mm) const {
  Eigen::MatrixXf score = edge.cwiseMin(1);
  const std::optional<Tissue> tissue = learned() ? std::nullopt : std::optional<Tissue>(profiles);
  in_parallel(score.cols(), [&](Eigen::Index from, Eigen::Index to) {
    for (Eigen::Index i = from; i < to; ++i) {
      float rightly_mm = 0;  // the organ's tissue within, minus foreign one
      for (Eigen::Index k = 0; k < score.rows(); ++k) {
        if (tissue) rightly_mm += static_cast<float>(step_mm_) * tissue->belongs(profiles.values(k, i));
        const auto away = static_cast<float>(profiles.at_mm(k) / reach_mm);
        score(k, i) += misplaced_per_mm * rightly_mm - farthest_cost * away * away;
      }
    }
  });
  return score;
}

/// How far an edge of this height is to be trusted, 0…1.
float EdgeSearch::clearness(float height) const {
  if (learned()) return std::clamp((height - least_likeness) / (full_likeness - least_likeness), 0.0f, 1.0f);
  const float over_noise = height * usual_contrast_ - least_grains * grain_;
  const float sure = grain_ > 0 ? std::clamp(over_noise / ((clear_grains - least_grains) * grain_), 0.0f, 1.0f) : 1;
  return std::min(height * height, 1.0f) * sure;
}

TargetPull EdgeSearch::find(const Mesh& mesh, double reach_mm) const {
  TargetPull pull{mesh.points, VertexScalars::Zero(mesh.points.rows())};
  if (!sees_edges()) return pull;
  const Profiles profiles = profiles_of(mesh, reach_mm);
  const Eigen::MatrixXf edge = edges(profiles), score = scores(profiles, edge, reach_mm);
  const auto reach = static_cast<Eigen::Index>(reach_mm / step_mm_);
  VertexScalars shift_mm = VertexScalars::Zero(mesh.points.rows());
  for (Eigen::Index i = 0; i < mesh.points.rows(); ++i) {
    const auto peak = best_peak(edge.col(i), score.col(i), reach);
    if (!peak) continue;
    shift_mm[i] = peak->at * step_mm_;
    pull.weights[i] = clearness(peak->height);
  }
  pull.targets += shift_mm.asDiagonal() * profiles.normals;
  const double tolerance_mm = std::max({least_agreeing_mm, 2 * step_mm_, agreeing_share * reach_mm});
  pull.weights = pull.weights.cwiseProduct(neighbours_agreement(*mesh.topology, shift_mm, pull.weights, tolerance_mm));
  return pull;
}

}  // namespace homolog
