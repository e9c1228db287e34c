#include "core/adapt/image/tissue.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/numbers/statistics.h"

namespace homolog {

namespace {

constexpr Eigen::Index tissue_bins = 64;
constexpr double counted_from_mm = 3, counted_to_mm = 12;  ///< nearer to the mesh a sample may be of either side
constexpr float unseen_share = 0.1f;  ///< share of the samples, spread over all bins: rare values prove little

/// Shares of a histogram, blurred by a bin or two.
Eigen::ArrayXf blurred_shares(Eigen::ArrayXf counts) {
  counts /= std::max(counts.sum(), 1.0f);
  for (int round = 0; round < 3; ++round) {
    const Eigen::ArrayXf sharp = counts;
    for (Eigen::Index b = 0; b < tissue_bins; ++b)
      counts[b] =
          0.5f * sharp[b] + 0.25f * (sharp[std::max<Eigen::Index>(b - 1, 0)] + sharp[std::min(b + 1, tissue_bins - 1)]);
  }
  return counts + unseen_share / tissue_bins;
}

Eigen::Index tissue_bin(float value, float low, float high) {
  const float place = (value - low) / (high - low) * static_cast<float>(tissue_bins);
  return std::clamp(static_cast<Eigen::Index>(std::floor(place)), Eigen::Index{0}, tissue_bins - 1);
}

}  // namespace

Tissue::Tissue(const Profiles& profiles) : balance_(Eigen::ArrayXf::Zero(tissue_bins)) {
  constexpr Eigen::Index stride = 3;  // enough of them to know the range
  std::vector<float> some;
  for (Eigen::Index k = 0; k < profiles.values.size(); k += stride)
    if (const float value = profiles.values.data()[k]; std::isfinite(value)) some.push_back(value);
  low_ = quantile(some, 0.005);
  high_ = quantile(some, 0.995);
  if (!(high_ > low_)) {
    high_ = low_ + 1;
    return;
  }
  Eigen::ArrayXf in = Eigen::ArrayXf::Zero(tissue_bins), out = in;
  for (Eigen::Index k = 0; k < profiles.values.rows(); ++k) {
    const double t_mm = profiles.at_mm(k);
    if (std::abs(t_mm) < counted_from_mm || std::abs(t_mm) > counted_to_mm) continue;
    for (Eigen::Index i = 0; i < profiles.values.cols(); ++i)
      if (const float value = profiles.values(k, i); std::isfinite(value))
        (t_mm < 0 ? in : out)[tissue_bin(value, low_, high_)] += 1;
  }
  const Eigen::ArrayXf p_in = blurred_shares(in), p_out = blurred_shares(out);
  balance_ = (p_in - p_out) / (p_in + p_out);
}

float Tissue::belongs(float intensity) const {
  return std::isfinite(intensity) ? balance_[tissue_bin(intensity, low_, high_)] : 0;
}

}  // namespace homolog
