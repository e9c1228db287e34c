#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/shapes.h"

namespace homolog::shapes {

/// Half a ball about 0, above z = 0 or below: a disc of rings, which both halves have vertex by vertex as their first
/// ones, and a dome on its rim.
inline Mesh half_ball(double radius_mm, bool above, int rings = 8, int sectors = 24) {
  std::vector<Vec3> points;
  std::vector<std::array<std::int32_t, 3>> faces;
  const double sign = above ? 1 : -1;
  const auto add_rings = [&](bool dome) {
    const auto first = static_cast<std::int32_t>(points.size());
    points.emplace_back(0, 0, dome ? sign * radius_mm : 0);
    for (int r = 1; r <= (dome ? rings - 1 : rings); ++r)
      for (int s = 0; s < sectors; ++s) {
        const double u = 2 * std::numbers::pi * s / sectors, v = std::numbers::pi / 2 * r / rings;
        const double out = radius_mm * (dome ? std::sin(v) : static_cast<double>(r) / rings);
        points.emplace_back(out * std::cos(u), out * std::sin(u), dome ? sign * radius_mm * std::cos(v) : 0);
      }
    const auto at = [&](int r, int s) {
      const int of = s % sectors;
      if (r == 0) return first;
      if (dome && r == rings) return static_cast<std::int32_t>(1 + (rings - 1) * sectors + of);  // the disc's rim
      return static_cast<std::int32_t>(first + 1 + (r - 1) * sectors + of);
    };
    const auto add = [&](std::int32_t a, std::int32_t b, std::int32_t c) {
      if (dome == above)
        faces.push_back({a, b, c});
      else
        faces.push_back({a, c, b});
    };
    for (int r = 0; r < rings; ++r)
      for (int s = 0; s < sectors; ++s) {
        add(at(r, s), at(r + 1, s), at(r + 1, s + 1));
        if (r > 0) add(at(r, s), at(r + 1, s + 1), at(r, s + 1));
      }
  };
  add_rings(false);
  add_rings(true);
  return make_mesh(points, faces);
}

/// How many vertices their disc has.
inline int disc_vertices(int rings = 8, int sectors = 24) {
  return 1 + rings * sectors;
}

}  // namespace homolog::shapes
