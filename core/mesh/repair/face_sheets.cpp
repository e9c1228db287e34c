#include "core/mesh/repair/face_sheets.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>

#include "core/base/numbers/index.h"

namespace homolog {
namespace {

constexpr double drawn_apart = 0.01;      ///< share of the way to its neighbours, for a vertex that was parted
constexpr std::size_t most_at_edge = 32;  ///< faces: where more meet, none are joined

/// One side of an edge: of `face`, from its `corner` to the next.
struct Side {
  std::int32_t low, high, face;
  int corner;
  bool ascending;  ///< runs from `low` to `high`
};

std::vector<Side> sorted_sides(const std::vector<Corners3>& faces) {
  std::vector<Side> sides;
  sides.reserve(3 * faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const std::int32_t from = faces[f][k], to = faces[f][(k + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), static_cast<std::int32_t>(f), k, from < to});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::array{a.low, a.high, a.face} < std::array{b.low, b.high, b.face};
  });
  return sides;
}

/// Calls `visit` with the sides of each edge.
template <class Visit>
void for_each_edge(const std::vector<Side>& sides, Visit visit) {
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high) ++end;
    visit(std::span(sides).subspan(i, end - i));
    i = end;
  }
}

/// The faces of a soup joined in pairs across their edges: a surface with rims, once corners are parted.
class Sheets {
 public:
  Sheets(Soup soup, MendedFaults& mended) : soup_(std::move(soup)), mended_(mended) {
    across_.assign(soup_.faces.size(), {-1, -1, -1});
    for_each_edge(sorted_sides(soup_.faces), [&](std::span<const Side> sides) {
      if (sides.size() == 2) join(sides[0], sides[1]);
      if (sides.size() > 2) join_crowded(sides);
    });
    orient();
  }

  /// Points and faces of a manifold.
  Soup parted() {
    const std::vector<std::int32_t> root = joined_corners();
    Soup result;
    number_vertices(root, result);
    split_doubled_edges(result);
    draw_apart(result);
    return result;
  }

 private:
  void join(const Side& a, const Side& b) {
    across_[a.face][a.corner] = 3 * b.face + b.corner;
    across_[b.face][b.corner] = 3 * a.face + a.corner;
  }

  /// The angle of each face about the edge that they share, from that of the first, in [0, 2π).
  std::vector<double> angles_of(std::span<const Side> sides) const {
    const Vec3 from = soup_.points.row(sides[0].low), to = soup_.points.row(sides[0].high);
    const Vec3 along = (to - from).stableNormalized();
    const auto outward = [&](const Side& side) {
      const std::int32_t third = soup_.faces[side.face][(side.corner + 2) % 3];
      const Vec3 way = Vec3(soup_.points.row(third)) - from;
      return Vec3(way - way.dot(along) * along);
    };
    const Vec3 u = outward(sides[0]).stableNormalized(), v = along.cross(u);
    std::vector<double> angles;
    for (const Side& side : sides) {
      const Vec3 way = outward(side);
      const double angle = std::atan2(way.dot(v), way.dot(u));
      angles.push_back(angle < 0 ? angle + 2 * std::numbers::pi : angle);
    }
    angles[0] = 0;
    return angles;
  }

  void join_crowded(std::span<const Side> sides) {
    ++mended_.non_manifold_edges;
    for (const Side& side : sides) {
      crowded_.push_back(side.low);
      crowded_.push_back(side.high);
    }
    if (sides.size() > most_at_edge) return;
    const std::vector<double> angles = angles_of(sides);
    std::vector<char> taken(sides.size(), 0);
    const auto take = [&](std::size_t a, std::size_t b) {
      join(sides[a], sides[b]);
      taken[a] = taken[b] = 1;
    };
    const auto up = std::count_if(sides.begin(), sides.end(), [](const Side& side) { return side.ascending; });
    if (2 * up == std::ssize(sides)) join_wedges(sides, angles, take, taken);
    // The rest: first faces that go on into each other most nearly flat, at last whichever there are.
    for (const bool opposite : {true, false})
      while (true) {
        std::pair<std::size_t, std::size_t> best{0, 0};
        double best_off = std::numeric_limits<double>::infinity();
        for (std::size_t a = 0; a < sides.size(); ++a)
          for (std::size_t b = a + 1; b < sides.size(); ++b) {
            if (taken[a] != 0 || taken[b] != 0 || (opposite && sides[a].ascending == sides[b].ascending)) continue;
            const double off = std::abs(std::abs(angles[a] - angles[b]) - std::numbers::pi);
            if (off < best_off) {
              best_off = off;
              best = {a, b};
            }
          }
        if (best.first == best.second) break;
        take(best.first, best.second);
      }
  }

  /// Joins the two faces of each wedge that solid fills: seen along the edge, a face that runs against it has the solid
  /// behind it, up to the next face that runs with it.
  template <class Take>
  static void join_wedges(std::span<const Side> sides, const std::vector<double>& angles, const Take& take,
                          const std::vector<char>& taken) {
    std::vector<std::size_t> around(sides.size());
    std::iota(around.begin(), around.end(), 0);
    std::sort(around.begin(), around.end(),
              [&](std::size_t a, std::size_t b) { return std::pair(angles[a], a) < std::pair(angles[b], b); });
    while (!around.empty()) {
      for (std::size_t i = 0; i < around.size(); ++i) {
        const std::size_t a = around[i], b = around[(i + 1) % around.size()];
        if (sides[a].ascending || !sides[b].ascending) continue;
        take(a, b);
        break;
      }
      std::erase_if(around, [&](std::size_t side) { return taken[side] != 0; });
    }
  }

  bool runs_up(std::int32_t side) const {
    const Corners3& face = soup_.faces[side / 3];
    return face[side % 3] < face[(side % 3 + 1) % 3];
  }

  /// Turns faces so that neighbours agree, the fewer of each part; cuts where that cannot be.
  void orient() {
    std::vector<char> seen(soup_.faces.size(), 0), turned(soup_.faces.size(), 0);
    std::vector<std::int32_t> part;
    for (std::size_t first = 0; first < soup_.faces.size(); ++first) {
      if (seen[first] != 0) continue;
      part.assign(1, static_cast<std::int32_t>(first));
      seen[first] = 1;
      std::size_t turns = 0;
      for (std::size_t next = 0; next < part.size(); ++next) {
        const std::int32_t f = part[next];
        for (int k = 0; k < 3; ++k) {
          const std::int32_t other = across_[f][k];
          if (other < 0) continue;
          const std::int32_t g = other / 3;
          const char wanted = (runs_up(3 * f + k) == runs_up(other)) != (turned[f] != 0);
          if (seen[g] == 0) {
            seen[g] = 1;
            turned[g] = wanted;
            turns += wanted != 0;
            part.push_back(g);
          } else if (turned[g] != wanted) {  // a surface with one side only
            across_[g][other % 3] = across_[f][k] = -1;
          }
        }
      }
      const bool most = 2 * turns > part.size();
      mended_.turned_faces += most ? part.size() - turns : turns;
      for (const std::int32_t f : part) turned[f] = (turned[f] != 0) != most;
    }
    turned_ = std::move(turned);
  }

  /// For each corner (3·face + k) the first corner of the same fan.
  std::vector<std::int32_t> joined_corners() const {
    std::vector<std::int32_t> root(3 * soup_.faces.size());
    std::iota(root.begin(), root.end(), 0);
    const auto find = [&](std::int32_t c) {
      while (root[c] != c) c = root[c] = root[root[c]];
      return c;
    };
    for (std::int32_t side = 0; side < std::ssize(root); ++side) {
      const std::int32_t other = across_[side / 3][side % 3];
      if (other < side) continue;
      const std::int32_t next = side / 3 * 3 + (side + 1) % 3, after = other / 3 * 3 + (other + 1) % 3;
      const bool along = vertex_at(side) == vertex_at(other);
      for (const auto& [a, b] : {std::pair(side, along ? other : after), std::pair(next, along ? after : other)}) {
        const std::int32_t ra = find(a), rb = find(b);
        root[std::max(ra, rb)] = std::min(ra, rb);
      }
    }
    for (std::int32_t c = 0; c < std::ssize(root); ++c) root[c] = find(c);
    return root;
  }

  std::int32_t vertex_at(std::int32_t corner) const { return soup_.faces[corner / 3][corner % 3]; }

  /// One vertex for each fan, in the order of the vertices that they were.
  void number_vertices(const std::vector<std::int32_t>& root, Soup& result) {
    std::vector<std::pair<std::int32_t, std::int32_t>> fans;  // the vertex, the first corner
    for (std::int32_t c = 0; c < std::ssize(root); ++c)
      if (root[c] == c) fans.emplace_back(vertex_at(c), c);
    std::sort(fans.begin(), fans.end());
    std::sort(crowded_.begin(), crowded_.end());
    std::vector<std::int32_t> number(root.size());
    result.points.resize(std::ssize(fans), 3);
    for (std::size_t n = 0; n < fans.size(); ++n) {
      number[fans[n].second] = static_cast<std::int32_t>(n);
      result.points.row(static_cast<Eigen::Index>(n)) = soup_.points.row(fans[n].first);
      const bool again = n > 0 && fans[n].first == fans[n - 1].first;
      const bool first_time = again && (n < 2 || fans[n].first != fans[n - 2].first);
      if (again) {
        apart_.push_back(static_cast<std::int32_t>(n - 1));
        apart_.push_back(static_cast<std::int32_t>(n));
      }
      mended_.non_manifold_vertices +=
          first_time && !std::binary_search(crowded_.begin(), crowded_.end(), fans[n].first);
    }
    for (std::int32_t c = 0; c < std::ssize(root); c += 3) {
      Corners3 face{number[root[c]], number[root[c + 1]], number[root[c + 2]]};
      result.faces.push_back(face);
    }
  }

  /// Splits edges at which sheets met and still share both ends: each but the first gets a vertex of its own in the
  /// edge's middle. Turns faces at last.
  void split_doubled_edges(Soup& result) {
    std::vector<Corners3> middle(result.faces.size(), {-1, -1, -1});
    std::vector<Eigen::RowVector3d> added;
    for_each_edge(sorted_sides(result.faces), [&](std::span<const Side> sides) {
      bool first = true;
      for (const Side& side : sides) {
        const std::int32_t self = 3 * side.face + side.corner, other = across_[side.face][side.corner];
        if (other >= 0 && other < self) continue;
        if (!std::exchange(first, false)) {
          const auto vertex = static_cast<std::int32_t>(result.points.rows() + std::ssize(added));
          added.push_back((result.points.row(side.low) + result.points.row(side.high)) / 2);
          apart_.push_back(vertex);
          middle[side.face][side.corner] = vertex;
          if (other >= 0) middle[other / 3][other % 3] = vertex;
        }
      }
    });
    const Eigen::Index before = result.points.rows();
    result.points.conservativeResize(before + std::ssize(added), 3);
    for (std::size_t n = 0; n < added.size(); ++n) result.points.row(before + static_cast<Eigen::Index>(n)) = added[n];
    std::vector<Corners3> faces;
    for (std::size_t f = 0; f < result.faces.size(); ++f) {
      std::vector<std::int32_t> polygon;
      std::size_t start = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        polygon.push_back(result.faces[f][k]);
        if (middle[f][k] < 0) continue;
        if (start == 0) start = polygon.size();
        polygon.push_back(middle[f][k]);
      }
      std::rotate(polygon.begin(), polygon.begin() + static_cast<std::ptrdiff_t>(start), polygon.end());
      for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
        Corners3 face{polygon[0], polygon[k], polygon[k + 1]};
        if (turned_[f] != 0) std::swap(face[1], face[2]);
        faces.push_back(face);
      }
    }
    result.faces = std::move(faces);
  }

  /// Draws vertices that were parted a little towards their own neighbours, so that sheets that touched do no more.
  void draw_apart(Soup& result) const {
    std::vector<Eigen::RowVector3d> sum(index(result.points.rows()), Eigen::RowVector3d::Zero());
    std::vector<double> count(sum.size(), 0);
    for (const Corners3& face : result.faces)
      for (std::size_t k = 0; k < 3; ++k)
        for (const std::size_t other : {(k + 1) % 3, (k + 2) % 3}) {
          sum[face[k]] += result.points.row(face[other]);
          ++count[face[k]];
        }
    std::vector<char> done(sum.size(), 0);
    for (const std::int32_t v : apart_) {
      if (std::exchange(done[v], 1) != 0) continue;
      result.points.row(v) += drawn_apart * (sum[v] / count[v] - result.points.row(v));
    }
  }

  Soup soup_;
  MendedFaults& mended_;
  std::vector<Corners3> across_;  ///< the side that each side is joined to (3·face + corner), or −1
  std::vector<char> turned_;
  std::vector<std::int32_t> crowded_;  ///< ends of edges with more than two faces
  std::vector<std::int32_t> apart_;    ///< vertices of the result that lay at one place with others
};

}  // namespace

Soup parted_sheets(Soup soup, MendedFaults& mended) {
  return Sheets(std::move(soup), mended).parted();
}

}  // namespace homolog
