#include "core/groupwise/other_organs.h"

#include <algorithm>
#include <cmath>

#include "core/base/numbers/statistics.h"

namespace homolog {

ShapeMatrix as_columns(const std::vector<std::optional<Points>>& fits, Eigen::Index vertices) {
  ShapeMatrix shapes(3 * vertices, std::ranges::count_if(fits, [](const auto& fit) { return fit.has_value(); }));
  Eigen::Index column = 0;
  for (const auto& fit : fits)
    if (fit) shapes.col(column++) = fit->reshaped<Eigen::RowMajor>();
  return shapes;
}

std::vector<double> shape_shares(ShapeMatrix fits) {
  align(fits, Alignment::similarity);
  const Eigen::VectorXd mean = fits.rowwise().mean();
  const double size = mean.norm();
  std::vector<double> shares;
  for (Eigen::Index k = 0; k < fits.cols(); ++k) shares.push_back(size > 0 ? (fits.col(k) - mean).norm() / size : 0);
  return shares;
}

std::vector<std::size_t> unlike_the_others(const std::vector<FitSigns>& fits) {
  constexpr std::size_t fewest = 3;
  constexpr double usual_doubt = 0.04;  ///< real organs of the template's kind come to 0.02 to 0.04
  constexpr double clear = 4;
  std::vector<std::size_t> unlike;
  if (fits.size() < fewest) return unlike;
  std::vector<double> doubts, distances;
  for (const FitSigns& one : fits) {
    doubts.push_back(one.doubt_share);
    distances.push_back(one.shape_share);
  }
  const double doubt = quantile(doubts, 0.5), distance = quantile(distances, 0.5);
  for (std::size_t k = 0; k < fits.size(); ++k) {
    const double own = fits[k].doubt_share;
    if (own > usual_doubt && own * std::max(1.0, fits[k].shape_share / distance) > clear * doubt) unlike.push_back(k);
  }
  return unlike;
}

std::vector<std::size_t> unlike_in_volume(const std::vector<double>& volumes) {
  constexpr std::size_t fewest = 5;
  constexpr double most_times = 3, most_deviations = 5, normal_median = 0.6745;
  std::vector<double> logarithms, deviations;
  for (const double volume : volumes)
    if (volume > 0) logarithms.push_back(std::log(volume));
  std::vector<std::size_t> unlike;
  if (logarithms.size() < fewest) return unlike;
  const double usual = quantile(logarithms, 0.5);
  for (const double one : logarithms) deviations.push_back(std::abs(one - usual));
  const double most = std::max(std::log(most_times), most_deviations / normal_median * quantile(deviations, 0.5));
  for (std::size_t k = 0; k < volumes.size(); ++k)
    if (volumes[k] > 0 && std::abs(std::log(volumes[k]) - usual) > most) unlike.push_back(k);
  return unlike;
}

}  // namespace homolog
