#include "core/model/alignment/numbering.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace homolog {

namespace {

constexpr Eigen::Index most_looked_at = 400;  ///< vertices, evenly over the numbers
constexpr std::size_t few_neighbours = 6;
constexpr double torn_share = 0.25;                    ///< share of the vertices looked at
constexpr double least_change = 1.7, most_change = 3;  ///< times a neighbourhood's width
constexpr double least_spread = 2;                     ///< any two points' ÷ neighbours': below, all are neighbours

/// Vertices and who lies beside each, in one shape.
struct Neighbourhoods {
  std::vector<Eigen::Index> vertices;
  std::vector<std::vector<std::int32_t>> neighbours;  ///< neighbours of each of these
  std::vector<double> width;                          ///< mean distance to them ÷ size of the shape
  double change = most_change;  ///< a width differs by more in another order; 0: too few points to tell
};

double mean_distance(const Points& points, Eigen::Index vertex, const std::vector<std::int32_t>& others) {
  double sum = 0;
  for (const std::int32_t j : others) sum += (points.row(j) - points.row(vertex)).norm();
  return others.empty() ? 0 : sum / static_cast<double>(others.size());
}

std::vector<std::int32_t> nearest_of(const Points& points, Eigen::Index vertex) {
  std::vector<std::pair<double, std::int32_t>> by_distance;
  for (Eigen::Index j = 0; j < points.rows(); ++j)
    if (j != vertex)
      by_distance.emplace_back((points.row(j) - points.row(vertex)).squaredNorm(), static_cast<std::int32_t>(j));
  const std::size_t count = std::min(few_neighbours, by_distance.size());
  std::partial_sort(by_distance.begin(), by_distance.begin() + static_cast<std::ptrdiff_t>(count), by_distance.end());
  std::vector<std::int32_t> nearest;
  for (std::size_t k = 0; k < count; ++k) nearest.push_back(by_distance[k].second);
  return nearest;
}

/// Root mean square distance of the vertices from their middle; 0 where the shape has no extent.
double size_of_shape(const Points& points) {
  return centroid_size_mm(points) / std::sqrt(static_cast<double>(points.rows()));
}

Neighbourhoods neighbourhoods_of(const Points& points, const Topology* topology) {
  Neighbourhoods all;
  const double size = size_of_shape(points);
  const Eigen::Index step = std::max<Eigen::Index>(1, points.rows() / most_looked_at);
  for (Eigen::Index i = 0; i < points.rows(); i += step) {
    std::vector<std::int32_t> beside;
    if (topology == nullptr)
      beside = nearest_of(points, i);
    else
      beside.assign(topology->one_ring(i).begin(), topology->one_ring(i).end());
    all.vertices.push_back(i);
    all.width.push_back(size > 0 ? mean_distance(points, i, beside) / size : 0);
    all.neighbours.push_back(std::move(beside));
  }
  // Two points taken at random lie √2 sizes apart, neighbours among n points on a ball 3.8/√n.
  const double spread = std::sqrt(2.0 * static_cast<double>(points.rows())) / 3.8;
  all.change = spread < least_spread ? 0 : std::clamp(std::sqrt(spread), least_change, most_change);
  return all;
}

/// The share of neighbourhoods that are several times as wide or narrow in another shape.
double torn_in(const Neighbourhoods& known, const Points& points) {
  const double size = size_of_shape(points);
  if (known.change == 0 || !(size > 0)) return 0;
  std::size_t torn = 0, counted = 0;
  for (std::size_t k = 0; k < known.vertices.size(); ++k) {
    const double width = mean_distance(points, known.vertices[k], known.neighbours[k]) / size;
    if (!(width > 0) && !(known.width[k] > 0)) continue;
    ++counted;
    if (width > known.change * known.width[k] || known.width[k] > known.change * width) ++torn;
  }
  return counted > 0 ? static_cast<double>(torn) / static_cast<double>(counted) : 0;
}

struct Alike {
  Neighbourhoods known;  ///< the neighbourhoods of the first of them
  std::vector<Eigen::Index> shapes;
};

double mean_width(const Alike& group) {
  double sum = 0;
  for (const double width : group.known.width) sum += width;
  return sum;
}

}  // namespace

OtherNumbering other_numbering(const ShapeMatrix& shapes, const std::shared_ptr<const Topology>& topology) {
  OtherNumbering other;
  std::vector<Alike> groups;
  for (Eigen::Index s = 0; s < shapes.cols(); ++s) {
    const Points points = points_of(shapes, s);
    const auto group = std::find_if(groups.begin(), groups.end(),
                                    [&](const Alike& one) { return torn_in(one.known, points) < torn_share; });
    if (group != groups.end())
      group->shapes.push_back(s);
    else
      groups.push_back({neighbourhoods_of(points, topology.get()), {s}});
  }
  if (groups.size() < 2) return other;
  // Of groups as large, the one whose faces are small is in the order of the faces.
  const auto better = [&](const Alike& a, const Alike& b) {
    if (a.shapes.size() != b.shapes.size()) return a.shapes.size() > b.shapes.size();
    return topology && mean_width(a) < mean_width(b);
  };
  std::size_t best = 0;
  for (std::size_t g = 1; g < groups.size(); ++g)
    if (better(groups[g], groups[best])) best = g;
  other.example = groups[best].shapes.front();
  for (std::size_t g = 0; g < groups.size(); ++g)
    if (g != best) other.shapes.insert(other.shapes.end(), groups[g].shapes.begin(), groups[g].shapes.end());
  std::sort(other.shapes.begin(), other.shapes.end());
  return other;
}

}  // namespace homolog
