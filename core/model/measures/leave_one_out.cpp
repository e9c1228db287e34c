#include "core/model/measures/leave_one_out.h"

#include <algorithm>
#include <cmath>

#include "core/base/demand.h"
#include "core/base/processes/parallel.h"

namespace homolog {

namespace {

/// Poles nearer to each other than this share of the largest count as one, coefficients whose square is smaller (as a
/// share of their scatter) as none: both are below what the components are known to.
constexpr double same_pole = 1e-14;
constexpr double untouched = 1e-28;
/// An eigenvalue below this share of the largest is rounding, no mode.
constexpr double mode_share = 1e-13;

constexpr const char* needs_all =
    "an error beyond the modes needs all components of the shapes; compute them with principal_components";

}  // namespace

LeaveOneOut::LeaveOneOut(const PrincipalComponents& components, Eigen::Index shape) {
  const Eigen::VectorXd& d = components.scatter;
  shapes_ = static_cast<double>(components.shapes());
  rho_ = shapes_ / (shapes_ - 1);
  z_ = d.cwiseSqrt().cwiseProduct(components.vectors.row(shape).transpose());
  std::vector<double> poles, weights;
  for (Eigen::Index j = 0; j < d.size(); ++j) {
    const double square = z_[j] * z_[j];
    const bool touches = square > untouched * d[j];
    const bool known = !poles.empty() && poles.back() - d[j] <= same_pole * d[0];
    // Of several equal poles all but one stay eigenvalues of the others, on axes across z.
    if (!touches || known) modes_.push_back({d[j], 0, -1, 0});
    group_.push_back(touches ? static_cast<Eigen::Index>(poles.size()) - (known ? 1 : 0) : -1);
    if (!touches) continue;
    if (known) {
      weights.back() += square;
    } else {
      poles.push_back(d[j]);
      weights.push_back(square);
    }
  }
  if (const double rest = components.centred.col(shape).squaredNorm() - z_.squaredNorm();
      components.beyond > 0 && rest > untouched * d[0]) {
    poles.push_back(components.beyond_squares / components.beyond);
    weights.push_back(rest);
    knows_all_ = false;
  }
  poles_ = Eigen::Map<Eigen::VectorXd>(poles.data(), std::ssize(poles));
  weights_ = Eigen::Map<Eigen::VectorXd>(weights.data(), std::ssize(weights));
  for (Eigen::Index k = 0; k < poles_.size(); ++k) {
    const bool last = k + 1 == poles_.size();
    Mode mode = root_between(k, last);
    mode.square = 1 / (weights_.array() / (poles_.array() - poles_[mode.near] + mode.offset).square()).sum();
    (mode.eigenvalue > mode_share * d[0] ? modes_ : beyond_).push_back(mode);
  }
  std::stable_sort(modes_.begin(), modes_.end(),
                   [](const Mode& a, const Mode& b) { return a.eigenvalue > b.eigenvalue; });
}

/// The root below pole `upper` and above the next one (or 0). f = 1 − ρ Σ w_j/(p_j − μ) falls there from +∞ (or f(0))
/// to −∞; times the distances to both ends it is smooth, which Newton's steps inside a shrinking bracket make use of.
LeaveOneOut::Mode LeaveOneOut::root_between(Eigen::Index upper, bool down_to_zero) const {
  const double width = poles_[upper] - (down_to_zero ? 0 : poles_[upper + 1]);
  struct Value {
    double f, slope;
  };
  // By the offset t = pole − μ from a pole; for the lower end t < 0. As whole arrays, several at a time: all the time
  // of large sets goes here.
  Eigen::ArrayXd inverse(poles_.size());
  const auto value = [&](Eigen::Index pole, double t) {
    inverse = (poles_.array() - poles_[pole] + t).inverse();
    const double sum = (weights_.array() * inverse).sum(), squares = (weights_.array() * inverse.square()).sum();
    return Value{1 - rho_ * sum, rho_ * squares};  // slope: df/dt
  };
  const bool near_upper = down_to_zero || value(upper, width / 2).f > 0;
  const Eigen::Index near = near_upper ? upper : upper + 1;
  if (down_to_zero && value(upper, width).f <= 0) return {0, 0, upper, width};
  // f rises with t. Of t in [low, high], f < 0 at low and f > 0 at high.
  double low = near_upper ? 0 : -width / 2, high = near_upper ? (down_to_zero ? width : width / 2) : 0;
  double t = (low + high) / 2;
  for (int round = 0; round < 200; ++round) {
    const Value v = value(near, t);
    (v.f > 0 ? high : low) = t;
    const double from_upper = near_upper ? t : width + t, from_lower = width - from_upper;
    const double ends = down_to_zero ? from_upper : from_upper * from_lower;
    const double ends_slope = down_to_zero ? 1 : from_lower - from_upper;
    const double step = v.f * ends / (v.slope * ends + v.f * ends_slope);
    double next = t - step;
    if (!(next >= low && next <= high)) next = (low + high) / 2;
    const double change = std::abs(next - t);
    t = next;
    if (change <= 4e-16 * std::abs(t) || v.f == 0) break;
  }
  return {poles_[near] - t, 0, near, t};
}

Eigen::VectorXd LeaveOneOut::squared_errors(Eigen::Index most_modes) const {
  demand(knows_all_, needs_all);
  Eigen::VectorXd errors(most_modes + 1);
  double error = beyond_.empty() ? 0 : beyond_.front().square;
  const auto known = static_cast<Eigen::Index>(modes_.size());
  // From the last mode up: a sum of squares, in which nothing cancels.
  for (Eigen::Index m = std::max(known, most_modes); m >= 0; --m) {
    if (m < known) error += modes_[m].square;
    if (m <= most_modes) errors[m] = error;
  }
  return errors;
}

Eigen::VectorXd LeaveOneOut::part_along(const Mode& mode) const {
  Eigen::VectorXd part = Eigen::VectorXd::Zero(z_.size());
  if (mode.near < 0) return part;
  for (Eigen::Index j = 0; j < z_.size(); ++j) {
    const Eigen::Index pole = group_[j];
    if (pole >= 0) part[j] = z_[j] / distance(pole, mode) * mode.square;
  }
  return part;
}

Eigen::VectorXd LeaveOneOut::error(Eigen::Index modes) const {
  demand(knows_all_, needs_all);
  Eigen::VectorXd error = Eigen::VectorXd::Zero(z_.size());
  for (const Mode& mode : beyond_) error += part_along(mode);
  for (std::size_t k = static_cast<std::size_t>(modes); k < modes_.size(); ++k) error += part_along(modes_[k]);
  return error;
}

double LeaveOneOut::mahalanobis(Eigen::Index modes) const {
  double squared = 0;
  const auto known = std::min(static_cast<std::size_t>(modes), modes_.size());
  for (std::size_t k = 0; k < known; ++k) squared += modes_[k].square / modes_[k].eigenvalue * (shapes_ - 2);
  return std::sqrt(squared);
}

Eigen::VectorXd left_out_distances(const PrincipalComponents& components, Eigen::Index modes) {
  constexpr Eigen::Index enough = 4;
  if (components.shapes() < enough) return {};
  Eigen::VectorXd distances(components.shapes());
  in_parallel(components.shapes(), [&](Eigen::Index first, Eigen::Index last) {
    for (Eigen::Index i = first; i < last; ++i) distances[i] = LeaveOneOut(components, i).mahalanobis(modes);
  });
  return distances;
}

Eigen::MatrixXd left_out_errors(const PrincipalComponents& components, Eigen::Index modes) {
  const Eigen::MatrixXd weights = components.weights();
  Eigen::MatrixXd combinations(weights.rows(), components.shapes());
  constexpr Eigen::Index block = 64;  // a table of all errors would be as large as the weights
  in_parallel(
      components.shapes(),
      [&](Eigen::Index first, Eigen::Index last) {
        Eigen::MatrixXd errors(weights.cols(), block);
        for (Eigen::Index i = first; i < last; i += block) {
          const Eigen::Index count = std::min(block, last - i);
          for (Eigen::Index k = 0; k < count; ++k) errors.col(k) = LeaveOneOut(components, i + k).error(modes);
          combinations.middleCols(i, count).noalias() = weights * errors.leftCols(count);
        }
      },
      block);
  return combinations;
}

}  // namespace homolog
