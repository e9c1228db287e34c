#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/numbers/geometry.h"

namespace homolog::formats {

/// Cuts polygons into triangles that lie within their outlines, seen along the polygon's normal, by cutting off ears
/// [Meisters 1975, Polygons have ears]. Corners on a straight edge get no flat triangle where another cut is possible.
class PolygonCutter {
 public:
  /// `points` outlives it.
  explicit PolygonCutter(const Points& points) : points_(points) {}

  /// `fan` holds the n − 2 triangles (a, b, c), (a, c, d), … of a polygon a, b, c, d, …. They stay where all of them
  /// look the same way; else other n − 2 triangles take their place. A polygon that has no inside (an outline that
  /// crosses itself, no area, corners that no point belongs to) stays a fan as far as no ear is found. False where all
  /// polygons together would take long: nothing is changed then.
  bool cut(std::span<std::int32_t> fan);

 private:
  bool spread(std::span<const std::int32_t> fan);
  double area(std::size_t a, std::size_t b, std::size_t c) const;
  bool fan_lies_within() const;
  bool is_ear(std::size_t at);

  const Points& points_;
  std::vector<std::int32_t> corners_;  ///< the polygon's corners, in turn
  std::vector<Eigen::Vector2d> flat_;  ///< the same in its plane, counter-clockwise
  std::vector<std::size_t> left_;      ///< those that are not cut off yet
  double least_area_ = 0;              ///< below which a triangle is flat, twice
  std::size_t looked_at_ = 0;          ///< corners compared with ears so far
};

}  // namespace homolog::formats
