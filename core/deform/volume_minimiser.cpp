#include "core/deform/volume_minimiser.h"

#include <deque>

namespace homolog {
namespace {

/// The last steps of a minimiser and how the slope changed over them [Nocedal 1980].
class StepMemory {
 public:
  void add(Eigen::VectorXd step, Eigen::VectorXd change) {
    const double product = step.dot(change);
    if (!(product > 1e-12 * step.norm() * change.norm())) return;
    if (kept_.size() == most) kept_.pop_front();
    kept_.push_back({std::move(step), std::move(change), 1 / product});
  }
  void clear() { kept_.clear(); }

  /// The step that the slope asks for. `first_guess` takes a slope times the inverse of about its second derivatives.
  template <class Guess>
  Eigen::VectorXd step_for(Eigen::VectorXd slope, const Guess& first_guess) const {
    std::vector<double> factors(kept_.size());
    for (std::size_t k = kept_.size(); k-- > 0;) {
      factors[k] = kept_[k].inverse * kept_[k].step.dot(slope);
      slope -= factors[k] * kept_[k].change;
    }
    Eigen::VectorXd step = first_guess(slope);
    for (std::size_t k = 0; k < kept_.size(); ++k)
      step += (factors[k] - kept_[k].inverse * kept_[k].change.dot(step)) * kept_[k].step;
    return -step;
  }

 private:
  static constexpr std::size_t most = 6;
  struct Pair {
    Eigen::VectorXd step, change;
    double inverse;
  };
  std::deque<Pair> kept_;
};

}  // namespace

double Springs::value(const Points& x, Points* gradient) const {
  double sum = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const Eigen::RowVector3d off = (x.row(points[k]) - places.row(row)) / length_mm;
    const double height = (x.row(points[k]) - feet.row(row)).dot(normals.row(row)) / length_mm;
    sum += along * off.squaredNorm() + across * height * height;
    if (gradient != nullptr)
      gradient->row(points[k]) += 2 / length_mm * (along * off + across * height * normals.row(row));
  }
  return sum;
}

bool Minimiser::run(Points& points, int most_rounds, Progress* progress) const {
  for (int round = 0; round < most_rounds; ++round) {
    const double epsilon = energy_.epsilon_for(points);
    const double first = value(points, epsilon, nullptr);
    if (!descend(points, epsilon, progress)) return false;
    const double last = value(points, epsilon, nullptr);
    const bool turned = energy_.least_determinant(points) <= 0;
    if (!turned && (epsilon < 1e-5 || first - last < 1e-3 * last)) break;
    if (progress != nullptr) progress->report((round + 1.0) / most_rounds);
  }
  return true;
}

double Minimiser::value(const Points& points, double epsilon, Points* gradient) const {
  const double of_elements = energy_.value(points, epsilon, gradient);
  return of_elements + springs_.value(points, gradient);
}

Eigen::VectorXd Minimiser::slope_of(const Points& gradient) const {
  const Points rows = gradient(moving_, Eigen::all);
  return rows.reshaped<Eigen::RowMajor>();
}

Eigen::VectorXd Minimiser::guessed(const Eigen::VectorXd& slope) const {
  const Points rows = Eigen::Map<const Points>(slope.data(), std::ssize(moving_), 3);
  return guess_(rows).reshaped<Eigen::RowMajor>();
}

bool Minimiser::descend(Points& points, double epsilon, Progress* progress) const {
  constexpr int most_steps = 40;
  const auto guess = [&](const Eigen::VectorXd& slope) { return guessed(slope); };
  StepMemory memory;
  Points gradient;
  double now = value(points, epsilon, &gradient);
  Eigen::VectorXd slope = slope_of(gradient);
  for (int k = 0; k < most_steps; ++k) {
    if (progress != nullptr && progress->cancelled()) return false;
    Eigen::VectorXd step = memory.step_for(slope, guess);
    double along = slope.dot(step);
    if (!(along < 0)) {
      memory.clear();
      step = -guessed(slope);
      along = slope.dot(step);
    }
    if (!(-along > 1e-7 * now)) return true;
    Points next;
    double then = now, share = 1;
    for (; share > 1e-8; share *= 0.5) {
      next = points;
      next(moving_, Eigen::all) += share * Eigen::Map<const Points>(step.data(), std::ssize(moving_), 3);
      then = value(next, epsilon, nullptr);
      if (then <= now + 1e-4 * share * along) break;
    }
    if (share <= 1e-8) return true;
    const bool settled = now - then < 1e-5 * then;
    points = std::move(next);
    now = value(points, epsilon, &gradient);
    Eigen::VectorXd next_slope = slope_of(gradient);
    memory.add(share * step, next_slope - slope);
    slope = std::move(next_slope);
    if (settled) return true;
  }
  return true;
}

}  // namespace homolog
