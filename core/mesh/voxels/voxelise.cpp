#include "core/mesh/voxels/voxelise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "core/mesh/geometry/predicates.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {
namespace {

using Vec2 = Eigen::Vector2d;

/// Ties are broken as if every voxel centre lay at (i + ε, j + ε², k + ε³) for an ε smaller than any number: then no
/// centre is on a face and no ray through an edge, and meshes that share a boundary share out its voxels.

/// Side of the line a → b on which (j + ε², k + ε³) lies: 1 left, −1 right; 0 only where a = b.
int side_of(const Vec2& a, const Vec2& b, const Vec2& at) {
  if (const int side = orientation(a, b, at); side != 0) return side;
  if (a.y() != b.y()) return a.y() > b.y() ? 1 : -1;
  return (b.x() > a.x()) - (b.x() < a.x());
}

/// First and last integer of [0, size) in [low, high]; empty where last < first.
std::pair<int, int> integers_in(double low, double high, int size) {
  return {static_cast<int>(std::ceil(std::clamp(low, 0.0, static_cast<double>(size)))),
          static_cast<int>(std::floor(std::clamp(high, -1.0, size - 1.0)))};
}

/// One triangle in voxel coordinates, seen along i.
class Face {
 public:
  Face(const Vec3& a, const Vec3& b, const Vec3& c)
      : corners_{a, b, c},
        flat_{Vec2(a.tail<2>()), Vec2(b.tail<2>()), Vec2(c.tail<2>())},
        turn_(orientation(flat_[0], flat_[1], flat_[2])) {}

  bool edge_on() const { return turn_ == 0; }
  double low(int axis) const { return std::min({corners_[0][axis], corners_[1][axis], corners_[2][axis]}); }
  double high(int axis) const { return std::max({corners_[0][axis], corners_[1][axis], corners_[2][axis]}); }

  /// Range of j that the face covers in row k, with room for rounding.
  std::pair<double, double> span_in_row(int k) const {
    double low_j = high(1), high_j = low(1);
    for (std::size_t e = 0; e < 3; ++e) {
      const Vec2 &a = flat_[e], &b = flat_[(e + 1) % 3];
      if (std::min(a.y(), b.y()) > k || std::max(a.y(), b.y()) < k) continue;
      const double t = a.y() == b.y() ? 0 : (k - a.y()) / (b.y() - a.y());
      for (const double j : {a.x() + t * (b.x() - a.x()), a.y() == b.y() ? b.x() : a.x() + t * (b.x() - a.x())}) {
        low_j = std::min(low_j, j);
        high_j = std::max(high_j, j);
      }
    }
    const double room = 1e-9 * (1 + std::abs(low_j) + std::abs(high_j));
    return {low_j - room, high_j + room};
  }
  bool covers(int j, int k) const {
    const Vec2 at(j, k);
    return side_of(flat_[0], flat_[1], at) == turn_ && side_of(flat_[1], flat_[2], at) == turn_ &&
           side_of(flat_[2], flat_[0], at) == turn_;
  }
  /// First voxel i, at most `size`, whose centre lies behind the face on the ray through (j, k), which it covers.
  int first_behind(int j, int k, int size) const {
    const auto behind = [&](int i) {
      return orientation(corners_[0], corners_[1], corners_[2], Vec3(i, j, k)) * turn_ >= 0;
    };
    const Vec3 normal = (corners_[1] - corners_[0]).cross(corners_[2] - corners_[0]);
    const double crossing =
        corners_[0].x() - (normal.y() * (j - corners_[0].y()) + normal.z() * (k - corners_[0].z())) / normal.x();
    int i = !(crossing > 0) ? 0 : crossing < size ? static_cast<int>(std::ceil(crossing)) : size;
    while (i > 0 && behind(i - 1)) --i;
    while (i < size && !behind(i)) ++i;
    return i;
  }

 private:
  std::array<Vec3, 3> corners_;
  std::array<Vec2, 3> flat_;  ///< (j, k)
  int turn_;
};

/// Turns a row whose ones are crossings into one whose ones are inside: from every odd crossing up to the next.
void fill_between_crossings(std::uint8_t* row, std::size_t length) {
  std::uint8_t* const end = row + length;
  const auto next_crossing = [end](std::uint8_t* from) {
    void* found = std::memchr(from, 1, static_cast<std::size_t>(end - from));
    return found != nullptr ? static_cast<std::uint8_t*>(found) : end;
  };
  for (std::uint8_t* entry = next_crossing(row); entry != end;) {
    std::uint8_t* const exit = next_crossing(entry + 1);
    std::fill(entry, exit, std::uint8_t{1});
    if (exit == end) return;
    *exit = 0;
    entry = next_crossing(exit + 1);
  }
}

}  // namespace

std::vector<std::uint8_t> voxelise(const Mesh& mesh, const VolumeGeometry& grid) {
  const Mesh closed = capped(mesh);
  Points voxel_points(closed.points.rows(), 3);
  for (Eigen::Index v = 0; v < closed.points.rows(); ++v) voxel_points.row(v) = grid.to_voxel(closed.points.row(v));

  const int size_i = grid.dims[0], size_j = grid.dims[1], size_k = grid.dims[2];
  const auto row_length = static_cast<std::size_t>(size_i);
  std::vector<std::uint8_t> inside(grid.voxels(), 0);
  std::vector<char> row_is_crossed(static_cast<std::size_t>(size_j) * static_cast<std::size_t>(size_k), 0);
  const auto row_of = [&](int j, int k) {
    return static_cast<std::size_t>(k) * static_cast<std::size_t>(size_j) + static_cast<std::size_t>(j);
  };
  for (Eigen::Index f = 0; f < closed.topology->triangles().rows(); ++f) {
    const auto t = closed.topology->triangles().row(f);
    const Face face(voxel_points.row(t[0]), voxel_points.row(t[1]), voxel_points.row(t[2]));
    if (face.edge_on()) continue;
    const auto [first_k, last_k] = integers_in(face.low(2), face.high(2), size_k);
    for (int k = first_k; k <= last_k; ++k) {
      const auto [low_j, high_j] = face.span_in_row(k);
      const auto [first_j, last_j] = integers_in(low_j, high_j, size_j);
      for (int j = first_j; j <= last_j; ++j) {
        if (!face.covers(j, k)) continue;
        const int i = face.first_behind(j, k, size_i);
        if (i == size_i) continue;
        inside[row_of(j, k) * row_length + static_cast<std::size_t>(i)] ^= 1;
        row_is_crossed[row_of(j, k)] = 1;
      }
    }
  }
  for (std::size_t row = 0; row < row_is_crossed.size(); ++row)
    if (row_is_crossed[row]) fill_between_crossings(inside.data() + row * row_length, row_length);
  return inside;
}

}  // namespace homolog
