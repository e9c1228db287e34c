#include "core/mesh/parts/rims.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/numbers/nearest_on_segment.h"
#include "core/base/numbers/statistics.h"

namespace homolog {

namespace {

constexpr int rim_samples = 1000;  ///< samples of all rims of a surface, at equal steps along them

/// From the rims of one surface to those of another: places at equal steps.
std::vector<double> directed_rim_distances(const std::vector<Rim>& from, const Points& points,
                                           const std::vector<Rim>& to, const Points& there, double step_mm) {
  std::vector<double> distances;
  for (const Rim& rim : from) {
    double walked_mm = 0, next_mm = 0;
    for (std::size_t k = 0; k < rim.size(); ++k) {
      const Vec3 a = points.row(rim[k]), b = points.row(rim[(k + 1) % rim.size()]);
      const double edge_mm = (b - a).norm();
      for (; next_mm < walked_mm + edge_mm; next_mm += step_mm) {
        const Vec3 p = a + (next_mm - walked_mm) / edge_mm * (b - a);
        distances.push_back((nearest_on_rims(to, there, p).position - p).norm());
      }
      walked_mm += edge_mm;
    }
  }
  return distances;
}

/// Smooths values on a circle: the least squares of (u − values)² + neighbours_count · (differences of neighbours)².
std::vector<double> smooth_on_circle(const std::vector<double>& values) {
  constexpr double neighbours_count = 4, negligible = 1e-12;
  const double decay = (1 + 2 * neighbours_count - std::sqrt(1 + 4 * neighbours_count)) / (2 * neighbours_count);
  const auto n = static_cast<std::ptrdiff_t>(values.size());
  const auto reach = static_cast<std::ptrdiff_t>(std::log(negligible) / std::log(decay));
  std::vector<double> smooth(values.size());
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    double sum = 0, weights = 0;
    for (std::ptrdiff_t d = -reach; d <= reach; ++d) {
      const double weight = std::pow(decay, static_cast<double>(std::abs(d)));
      sum += weight * values[((k + d) % n + n) % n];
      weights += weight;
    }
    smooth[k] = sum / weights;
  }
  return smooth;
}

/// A rim as a way around, mm from its first vertex.
class WayAround {
 public:
  WayAround(const Rim& rim, const Points& points) : rim_(rim), points_(points), at_{0} {
    for (const double edge_mm : rim_edges_mm(rim, points)) at_.push_back(at_.back() + edge_mm);
  }
  double length_mm() const { return at_.back(); }
  /// The place along it that is nearest to `p`.
  double nearest_mm(const Vec3& p) const {
    const RimPlace place = nearest_on_rims({rim_}, points_, p);
    const auto k = static_cast<std::size_t>(std::ranges::find(rim_, place.between[0]) - rim_.begin());
    return at_[k] + place.share * (at_[k + 1] - at_[k]);
  }
  Vec3 place(double mm) const {
    mm -= std::floor(mm / length_mm()) * length_mm();
    const auto after = std::upper_bound(at_.begin() + 1, at_.end() - 1, mm);
    const auto k = static_cast<std::size_t>(after - at_.begin()) - 1;
    const double edge_mm = at_[k + 1] - at_[k], share = edge_mm > 0 ? (mm - at_[k]) / edge_mm : 0;
    const Vec3 a = points_.row(rim_[k]), b = points_.row(rim_[(k + 1) % rim_.size()]);
    return a + share * (b - a);
  }

 private:
  const Rim& rim_;
  const Points& points_;
  std::vector<double> at_;  ///< one for each vertex, and once more for the first
};

double length_of_all_mm(const std::vector<Rim>& rims, const Points& points) {
  double length_mm = 0;
  for (const Rim& rim : rims) length_mm += rim_length_mm(rim, points);
  return length_mm;
}

}  // namespace

std::vector<double> rim_edges_mm(const Rim& rim, const Points& points) {
  std::vector<double> edges_mm;
  for (std::size_t k = 0; k < rim.size(); ++k)
    edges_mm.push_back((points.row(rim[k]) - points.row(rim[(k + 1) % rim.size()])).norm());
  return edges_mm;
}

double rim_length_mm(const Rim& rim, const Points& points) {
  double length_mm = 0;
  for (const double edge_mm : rim_edges_mm(rim, points)) length_mm += edge_mm;
  return length_mm;
}

std::vector<Vec3> spread_on_rim(const Rim& rim, const Points& points, const std::vector<double>& rest_mm,
                                const Rim& onto, const Points& there) {
  const WayAround way(onto, there);
  double rest_length_mm = 0;
  for (const double edge_mm : rest_mm) rest_length_mm += edge_mm;
  const double ratio = way.length_mm() / rest_length_mm;
  // How far each vertex is ahead of an even spread. It rises and falls, and comes back to where it began.
  std::vector<double> nearest_mm, ahead_mm;
  for (const std::int32_t i : rim) nearest_mm.push_back(way.nearest_mm(points.row(i)));
  double along_mm = 0, ahead = nearest_mm.front();
  for (std::size_t k = 0; k < rim.size(); ++k) {
    ahead_mm.push_back(ahead);
    const double step_mm = nearest_mm[(k + 1) % rim.size()] - nearest_mm[k] - ratio * rest_mm[k];
    ahead += step_mm - std::round(step_mm / way.length_mm()) * way.length_mm();
  }
  const bool around = std::abs(ahead - ahead_mm.front()) < way.length_mm() / 2;
  if (around) ahead_mm = smooth_on_circle(ahead_mm);
  std::vector<Vec3> places;
  for (std::size_t k = 0; k < rim.size(); ++k) {
    places.push_back(way.place(around ? ahead_mm[k] + ratio * along_mm : nearest_mm[k]));
    along_mm += rest_mm[k];
  }
  return places;
}

std::vector<Rim> long_rims(const Mesh& mesh, double share) {
  const double least_mm = share * bounds_of(mesh.points).diagonal().norm();
  std::vector<Rim> rims;
  for (const Rim& rim : mesh.topology->rims())
    if (rim_length_mm(rim, mesh.points) > least_mm) rims.push_back(rim);
  return rims;
}

RimPlace nearest_on_rims(const std::vector<Rim>& rims, const Points& points, const Vec3& p) {
  RimPlace best;
  double least_mm2 = std::numeric_limits<double>::infinity();
  for (const Rim& rim : rims) {
    for (std::size_t k = 0; k < rim.size(); ++k) {
      const std::array<std::int32_t, 2> between{rim[k], rim[(k + 1) % rim.size()]};
      const Vec3 a = points.row(between[0]), b = points.row(between[1]);
      const double share = nearest_on_segment(p, a, b);
      const Vec3 position = a + share * (b - a);
      const double mm2 = (position - p).squaredNorm();
      if (!(mm2 < least_mm2)) continue;
      least_mm2 = mm2;
      best = {between, share, position};
    }
  }
  return best;
}

std::string closed_flat(const Topology& topology) {
  const std::size_t count = topology.rims().size();
  if (count == 0) return {};
  return "is open, so its " + (count == 1 ? "rim was" : std::to_string(count) + " rims were") +
         " closed flat to have an inside";
}

RimDistance rim_distance(const Mesh& a, const Mesh& b) {
  const std::vector<Rim> of_a = long_rims(a), of_b = long_rims(b);
  const double a_mm = length_of_all_mm(of_a, a.points), b_mm = length_of_all_mm(of_b, b.points);
  if (!(a_mm > 0 && b_mm > 0)) return {};
  const std::vector<double> forth = directed_rim_distances(of_a, a.points, of_b, b.points, a_mm / rim_samples),
                            back = directed_rim_distances(of_b, b.points, of_a, a.points, b_mm / rim_samples);
  return {(a_mm * mean_of(forth) + b_mm * mean_of(back)) / (a_mm + b_mm),
          std::max(quantile(forth, 0.95), quantile(back, 0.95))};
}

}  // namespace homolog
