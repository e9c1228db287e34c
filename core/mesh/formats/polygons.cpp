#include "core/mesh/formats/polygons.h"

#include <algorithm>

namespace homolog::formats {
namespace {

constexpr double flat_area_share = 1e-9;             ///< share of the square of the polygon's extent
constexpr std::size_t most_looked_at = 300'000'000;  ///< about two seconds

}  // namespace

/// Lays the polygon into its plane. False where it has none.
bool PolygonCutter::spread(std::span<const std::int32_t> fan) {
  corners_.assign({fan[0], fan[1]});
  for (std::size_t i = 2; i < fan.size(); i += 3) corners_.push_back(fan[i]);
  const auto outside = [&](std::int32_t v) { return v < 0 || v >= points_.rows(); };
  if (std::any_of(corners_.begin(), corners_.end(), outside)) return false;
  const auto at = [&](std::size_t k) { return Vec3(points_.row(corners_[k])); };
  const Vec3 origin = at(0);
  Vec3 normal = Vec3::Zero(), longest = Vec3::Zero();
  for (std::size_t k = 1; k < corners_.size(); ++k) {
    const Vec3 side = at(k) - origin;
    if (side.squaredNorm() > longest.squaredNorm()) longest = side;
    if (k + 1 < corners_.size()) normal += side.cross(at(k + 1) - origin);
  }
  least_area_ = flat_area_share * longest.squaredNorm();
  if (!(normal.norm() > least_area_)) return false;
  normal.normalize();
  const Vec3 u = (longest - normal * normal.dot(longest)).normalized(), v = normal.cross(u);
  flat_.clear();
  for (std::size_t k = 0; k < corners_.size(); ++k) flat_.emplace_back(u.dot(at(k) - origin), v.dot(at(k) - origin));
  return true;
}

/// Twice the area of a triangle, positive where it runs counter-clockwise.
double PolygonCutter::area(std::size_t a, std::size_t b, std::size_t c) const {
  const Eigen::Vector2d u = flat_[b] - flat_[a], v = flat_[c] - flat_[a];
  return u.x() * v.y() - u.y() * v.x();
}

bool PolygonCutter::fan_lies_within() const {
  for (std::size_t k = 1; k + 1 < flat_.size(); ++k)
    if (!(area(0, k, k + 1) > least_area_)) return false;
  return true;
}

/// Whether the corner with those before and behind it is a triangle that no other corner lies in or on.
bool PolygonCutter::is_ear(std::size_t at) {
  const std::size_t n = left_.size();
  ++looked_at_;
  const std::size_t a = left_[(at + n - 1) % n], b = left_[at], c = left_[(at + 1) % n];
  if (!(area(a, b, c) > least_area_)) return false;
  looked_at_ += n;
  return std::none_of(left_.begin(), left_.end(), [&](std::size_t p) {
    // Where an outline comes back to a corner, as to cut out a hole, that corner is its own neighbour.
    if (flat_[p] == flat_[a] || flat_[p] == flat_[b] || flat_[p] == flat_[c]) return false;
    return area(a, b, p) >= -least_area_ && area(b, c, p) >= -least_area_ && area(c, a, p) >= -least_area_;
  });
}

bool PolygonCutter::cut(std::span<std::int32_t> fan) {
  if (!spread(fan) || fan_lies_within()) return true;
  left_.resize(corners_.size());
  for (std::size_t k = 0; k < left_.size(); ++k) left_[k] = k;
  std::vector<std::int32_t> triangles;
  const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
    triangles.insert(triangles.end(), {corners_[a], corners_[b], corners_[c]});
  };
  std::size_t at = 0, failed = 0;
  while (left_.size() > 3 && failed < left_.size()) {
    if (looked_at_ > most_looked_at) return false;
    const std::size_t n = left_.size();
    at %= n;
    if (!is_ear(at)) {
      ++at;
      ++failed;
      continue;
    }
    add(left_[(at + n - 1) % n], left_[at], left_[(at + 1) % n]);
    left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(at));
    failed = 0;
  }
  for (std::size_t k = 1; k + 1 < left_.size(); ++k) add(left_[0], left_[k], left_[k + 1]);
  std::copy(triangles.begin(), triangles.end(), fan.begin());
  return true;
}

}  // namespace homolog::formats
