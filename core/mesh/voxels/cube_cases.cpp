#include "core/mesh/voxels/cube_cases.h"

#include <cassert>
#include <cstddef>
#include <utility>

namespace homolog {
namespace {

using Loop = std::vector<std::uint8_t>;  ///< edges whose middles are joined in turn

int corner_at(std::array<int, 3> offset) {
  return offset[0] | offset[1] << 1 | offset[2] << 2;
}

std::uint8_t edge_between(int a, int b) {
  const int axis = (a ^ b) == 1 ? 0 : (a ^ b) == 2 ? 1 : 2;
  return static_cast<std::uint8_t>(4 * axis + (a >> (axis + 1) % 3 & 1) + 2 * (a >> (axis + 2) % 3 & 1));
}

/// Corners of face (axis, side), counter-clockwise seen from outside the cube.
std::array<int, 4> corners_of_face(std::size_t axis, int side) {
  std::array<int, 4> corners{};
  constexpr int turn[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (std::size_t c = 0; c < 4; ++c) {
    std::array<int, 3> offset{};
    offset[axis] = side;
    offset[(axis + 1) % 3] = turn[c][side ? 0 : 1];
    offset[(axis + 2) % 3] = turn[c][side ? 1 : 0];
    corners[c] = corner_at(offset);
  }
  return corners;
}

/// For every crossed edge the next one on its loop. On each face a line runs from where the round of its corners comes
/// inside to where it goes outside next: this cuts every run of inside corners off alone.
std::array<int, 12> next_edges(int cube) {
  std::array<int, 12> next;
  next.fill(-1);
  const auto inside = [cube](int corner) { return (cube >> corner & 1) != 0; };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const auto corners = corners_of_face(axis, side);
      for (std::size_t c = 0; c < 4; ++c) {
        if (!inside(corners[c]) || inside(corners[(c + 1) % 4])) continue;
        std::size_t first = c;
        while (inside(corners[(first + 3) % 4])) first = (first + 3) % 4;
        next[edge_between(corners[(first + 3) % 4], corners[first])] = edge_between(corners[c], corners[(c + 1) % 4]);
      }
    }
  }
  return next;
}

/// Bits of the two faces that an edge lies on.
unsigned faces_of_edge(std::uint8_t edge) {
  const unsigned axis = edge / 4u, b = (axis + 1) % 3, c = (axis + 2) % 3;
  return 1u << (2 * b + (edge & 1u)) | 1u << (2 * c + (edge >> 1 & 1u));
}

/// Triangles of loop[first … last], whose closing edge is (last, first); every other inner edge joins faces that
/// differ.
bool triangulate(const Loop& loop, std::size_t first, std::size_t last, std::vector<CubeCases::Triangle>& triangles) {
  if (last - first < 2) return true;
  const auto allowed = [&](std::size_t a, std::size_t b) {
    return b - a == 1 || (faces_of_edge(loop[a]) & faces_of_edge(loop[b])) == 0;
  };
  for (std::size_t middle = first + 1; middle < last; ++middle) {
    const std::size_t before = triangles.size();
    if (allowed(first, middle) && allowed(middle, last) && triangulate(loop, first, middle, triangles) &&
        triangulate(loop, middle, last, triangles)) {
      triangles.push_back({loop[first], loop[middle], loop[last]});
      return true;
    }
    triangles.resize(before);
  }
  return false;
}

CubeCases derive() {
  CubeCases cases;
  for (int cube = 0; cube < 256; ++cube) {
    auto next = next_edges(cube);
    for (std::uint8_t start = 0; start < 12; ++start) {
      Loop loop;
      for (int edge = start; next[edge] >= 0;) {
        loop.push_back(static_cast<std::uint8_t>(edge));
        edge = std::exchange(next[edge], -1);
      }
      if (loop.empty()) continue;
      [[maybe_unused]] const bool done = triangulate(loop, 0, loop.size() - 1, cases.triangles[cube]);
      assert(done);
    }
  }
  return cases;
}

}  // namespace

const CubeCases& cube_cases() {
  static const CubeCases cases = derive();
  return cases;
}

}  // namespace homolog
