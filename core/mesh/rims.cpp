#include "core/mesh/rims.h"

#include <algorithm>
#include <limits>

#include "core/base/nearest_on_segment.h"
#include "core/base/statistics.h"

namespace homolog {

namespace {

constexpr int rim_samples = 1000;  ///< of all rims of a surface, at equal steps along them

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

double length_of_all_mm(const std::vector<Rim>& rims, const Points& points) {
  double length_mm = 0;
  for (const Rim& rim : rims) length_mm += rim_length_mm(rim, points);
  return length_mm;
}

}  // namespace

double rim_length_mm(const Rim& rim, const Points& points) {
  double length_mm = 0;
  for (std::size_t k = 0; k < rim.size(); ++k)
    length_mm += (points.row(rim[k]) - points.row(rim[(k + 1) % rim.size()])).norm();
  return length_mm;
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
