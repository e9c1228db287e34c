#include "core/structures/fitting/keep_apart.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "core/base/numbers/index.h"
#include "core/base/processes/parallel.h"
#include "core/deform/fold_guard.h"
#include "core/mesh/geometry/surface_search.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

namespace {

/// A place of a mesh as the mean of some of its vertices.
struct Sample {
  std::array<std::int32_t, 3> vertices{};
  int count = 0;

  Vec3 at(const Points& points) const {
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < count; ++k) sum += points.row(vertices[k]).transpose();
    return sum / count;
  }
};

std::vector<Sample> samples_of(const Topology& topology) {
  std::vector<Sample> samples;
  for (std::int32_t v = 0; v < topology.vertices(); ++v) samples.push_back({{v, v, v}, 1});
  for (const auto& [a, b] : topology.edges()) samples.push_back({{a, b, b}, 2});
  for (Eigen::Index f = 0; f < topology.triangles().rows(); ++f) {
    const auto t = topology.triangles().row(f);
    samples.push_back({{t[0], t[1], t[2]}, 3});
  }
  return samples;
}

Box grown(Box box, double by_mm) {
  box.min().array() -= by_mm;
  box.max().array() += by_mm;
  return box;
}

/// How far places lie within a mesh. What is nearest to the rim of an open one lies beyond where it ends, and so
/// outside.
class Depths {
 public:
  explicit Depths(const Mesh& mesh) : search_(mesh), normals_(mesh.topology->triangles().rows(), 3) {
    for (Eigen::Index f = 0; f < normals_.rows(); ++f) normals_.row(f) = area_normal(mesh, f).normalized();
  }

  /// Above 0 within; and the way out, of length 1.
  struct Depth {
    double mm;
    Vec3 out;
  };
  Depth at(const Vec3& p) const {
    const auto nearest = search_.nearest(p);
    const Vec3 normal = normal_at(nearest.at);
    const Vec3 away = p - nearest.position;
    const bool within = away.dot(normal) < 0 && !on_rim(*search_.mesh().topology, nearest.at);
    const Vec3 out = nearest.distance_mm > 1e-9 ? Vec3(within ? -away.normalized() : away.normalized()) : normal;
    return {within ? nearest.distance_mm : -nearest.distance_mm, out};
  }

 private:
  /// On an edge or at a corner the mean of the faces there, by their angles [Bærentzen & Aanæs 2005].
  Vec3 normal_at(const SurfacePoint& at) const {
    constexpr double nothing = 1e-9;
    const Topology& topology = *search_.mesh().topology;
    const auto t = topology.triangles().row(at.face);
    const Vec3 own = normals_.row(at.face);
    int corners = 0, corner = 0, apart = 0;
    for (int c = 0; c < 3; ++c) {
      if (at.weights[c] > nothing)
        ++corners, corner = c;
      else
        apart = c;
    }
    if (corners == 3) return own;
    if (corners == 2) {
      const std::int32_t across = topology.neighbours(at.face)[(apart + 1) % 3];
      return across < 0 ? own : Vec3(own + normals_.row(across).transpose());
    }
    const Points& points = search_.mesh().points;
    const std::int32_t v = t[corner];
    Vec3 sum = Vec3::Zero();
    for (const std::int32_t f : topology.faces_of(v)) {
      const auto face = topology.triangles().row(f);
      const int k = face[0] == v ? 0 : face[1] == v ? 1 : 2;
      const Vec3 a = points.row(face[(k + 1) % 3]) - points.row(v), b = points.row(face[(k + 2) % 3]) - points.row(v);
      sum += std::atan2(a.cross(b).norm(), a.dot(b)) * normals_.row(f).transpose();
    }
    return sum;
  }

  SurfaceSearch search_;
  Points normals_;
};

/// How the vertices of a mesh have to move, and which have to.
struct Push {
  Points by;
  VertexScalars mm;  ///< the largest that any sample asks for; 0: none does
  double deepest_mm = 0;
};

/// `share`: of the way that it goes.
Push push_out(const Mesh& mesh, const std::vector<Sample>& samples, const Depths& other, const Box& reach,
              double gap_mm, double share) {
  constexpr double slack_mm = 0.01;
  Push push{Points::Zero(mesh.points.rows(), 3), VertexScalars::Zero(mesh.points.rows())};
  for (const Sample& sample : samples) {
    const Vec3 p = sample.at(mesh.points);
    if (!reach.contains(p)) continue;
    const Depths::Depth depth = other.at(p);
    const double excess_mm = depth.mm + gap_mm;
    push.deepest_mm = std::max(push.deepest_mm, excess_mm);
    if (excess_mm <= 0 || share <= 0) continue;
    const double way_mm = share * (excess_mm + slack_mm);
    for (int k = 0; k < sample.count; ++k) {
      const std::int32_t v = sample.vertices[k];
      if (way_mm <= push.mm[v]) continue;
      push.mm[v] = way_mm;
      push.by.row(v) = way_mm * depth.out;
    }
  }
  return push;
}

/// Moves a mesh by steps, and takes a step back where it would turn a face or bring two faces through each other.
class UnfoldedSteps {
 public:
  explicit UnfoldedSteps(const Mesh& start)
      : start_(start.points), pace_(VertexScalars::Ones(start.points.rows())), known_(self_intersections(start)) {}

  /// Gives the largest way of a vertex, mm. `most_mm`: no vertex needs a longer one in all, as far as this step knows.
  double step(Mesh& mesh, const Points& by, double most_mm) {
    most_mm_ = std::max(most_mm_, most_mm);
    const Points before = mesh.points;
    pace_.setOnes();  // those that had to stay in the last step may go in this one
    for (int rings = 0; rings <= most_rings; ++rings) {
      for (Eigen::Index v = 0; v < by.rows(); ++v) {
        const Vec3 whole = (before.row(v) + pace_[v] * by.row(v) - start_.row(v)).transpose();
        const double mm = whole.norm();
        mesh.points.row(v) = start_.row(v) + std::min(1.0, most_mm_ / std::max(mm, 1e-12)) * whole.transpose();
      }
      const auto faces = folded(mesh);
      if (faces.empty()) return (mesh.points - before).rowwise().norm().maxCoeff();
      // Slower at first; what still folds then stays where it was.
      slow_down(*mesh.topology, faces, rings, rings < 2 ? 0.5 : 0);
    }
    mesh.points = before;
    return 0;
  }

 private:
  static constexpr int most_rings = 6;

  std::vector<std::int32_t> folded(const Mesh& mesh) const {
    auto faces = turned_triangles(*mesh.topology, start_, mesh.points);
    for (const auto& pair : self_intersections(mesh))
      if (!std::ranges::binary_search(known_, pair)) faces.insert(faces.end(), pair.begin(), pair.end());
    return faces;
  }
  /// Those of the faces and so many rings around them.
  void slow_down(const Topology& topology, const std::vector<std::int32_t>& faces, int rings, double by) {
    std::vector<char> near(index(topology.vertices()));
    for (const std::int32_t f : faces)
      for (int c = 0; c < 3; ++c) near[topology.triangles()(f, c)] = 1;
    for (int ring = 0; ring < rings; ++ring) {
      const std::vector<char> inner = near;
      for (std::int32_t v = 0; v < topology.vertices(); ++v)
        if (inner[v] != 0)
          for (const std::int32_t n : topology.one_ring(v)) near[n] = 1;
    }
    for (std::int32_t v = 0; v < topology.vertices(); ++v)
      if (near[v] != 0) pace_[v] *= by;
  }

  Points start_;
  VertexScalars pace_;  ///< the share of the step that a vertex goes
  double most_mm_ = 0;
  std::vector<std::array<std::int32_t, 2>> known_;  ///< faces that met at the start
};

}  // namespace

void spread_movement(const Topology& topology, const VertexScalars& held, Points& by, int rings) {
  for (int ring = 0; ring < rings; ++ring) {
    Points next = by;
    for (Eigen::Index v = 0; v < by.rows(); ++v) {
      if (held[v] > 0) continue;
      Vec3 sum = Vec3::Zero();
      for (const std::int32_t n : topology.one_ring(v)) sum += by.row(n).transpose();
      next.row(v) = sum / static_cast<double>(topology.one_ring(v).size());
    }
    by = std::move(next);
  }
}

double share_within(const Mesh& mesh, const ClosedMesh& other) {
  const Depths depths(other.mesh());
  const Box reach = bounds_of(other.points());
  Eigen::Index within = 0;
  for (Eigen::Index v = 0; v < mesh.points.rows(); ++v) {
    const Vec3 p = mesh.points.row(v);
    if (reach.contains(p) && depths.at(p).mm > 0) ++within;
  }
  return static_cast<double>(within) / static_cast<double>(mesh.points.rows());
}

double depth_mm(const Mesh& mesh, const Mesh& other, double near_mm) {
  const Depths depths(other);
  const Box reach = grown(bounds_of(other.points), near_mm);
  double deepest = -near_mm;
  for (const Sample& sample : samples_of(*mesh.topology))
    if (const Vec3 p = sample.at(mesh.points); reach.contains(p)) deepest = std::max(deepest, depths.at(p).mm);
  return deepest;
}

namespace {

/// One step of a mesh out of the others. Gives the largest way of a vertex, mm.
double go_out(Mesh& mesh, Push& move, double edge_mm, UnfoldedSteps& steps) {
  constexpr double step_edges = 0.5, deep = 1.5, rings_of_edge = 3, ample = 1.5;
  constexpr int least_rings = 4, most_rings = 40;
  // Deep within another mesh the nearest ways out part from each other: there it goes the mean way as a whole.
  const double way_mm = move.mm.maxCoeff(), deep_edges = way_mm / edge_mm;
  const VertexScalars held = deep_edges > deep ? VertexScalars::Zero(move.mm.size()) : move.mm;
  const int rings = std::clamp(static_cast<int>(std::ceil(rings_of_edge * deep_edges)), least_rings, most_rings);
  spread_movement(*mesh.topology, held, move.by, rings);
  // A way that is long beside the edges folds; the next round looks where to go on from there.
  const double longest_mm = move.by.rowwise().norm().maxCoeff(), most_mm = step_edges * edge_mm;
  if (longest_mm > most_mm) move.by *= most_mm / longest_mm;
  return steps.step(mesh, move.by, ample * way_mm);
}

}  // namespace

std::vector<double> keep_apart(std::vector<Mesh>& meshes, std::span<const MeshPair> pairs, double gap_mm,
                               const std::vector<char>& yields) {
  constexpr int most_rounds = 40, patient_rounds = 8;
  constexpr double least_gain = 0.01, at_rest_mm = 0.02, hardly_moved_mm = 0.002;
  std::vector<std::vector<Sample>> samples(meshes.size());
  for (const MeshPair& pair : pairs)
    for (const std::size_t k : pair)
      if (samples[k].empty()) samples[k] = samples_of(*meshes[k].topology);
  const auto share_of = [&](std::size_t own, std::size_t other) {
    if (yields.empty() || yields[own] == yields[other]) return 0.5;
    return yields[own] != 0 ? 1.0 : 0.0;
  };
  std::vector<double> left_mm(pairs.size());
  std::vector<std::optional<UnfoldedSteps>> steps(meshes.size());
  std::vector<double> edge_mm(meshes.size());
  for (std::size_t k = 0; k < meshes.size(); ++k)
    if (!samples[k].empty()) edge_mm[k] = mean_edge_mm(*meshes[k].topology, meshes[k].points);
  double least_mm = std::numeric_limits<double>::infinity();  // the least of all pairs together, in any round
  int since_gain = 0;
  for (int round = 0;; ++round) {
    std::vector<std::unique_ptr<Depths>> depths(meshes.size());
    for_each_in_parallel(meshes.size(), [&](std::size_t k) {
      if (!samples[k].empty()) depths[k] = std::make_unique<Depths>(meshes[k]);
    });
    std::vector<Push> pushes(2 * pairs.size());
    for_each_in_parallel(pushes.size(), [&](std::size_t p) {
      const std::size_t own = pairs[p / 2][p % 2], other = pairs[p / 2][1 - p % 2];
      const Box reach = grown(bounds_of(meshes[other].points), gap_mm);
      if (reach.intersects(bounds_of(meshes[own].points)))
        pushes[p] = push_out(meshes[own], samples[own], *depths[other], reach, gap_mm, share_of(own, other));
    });
    std::vector<Push> moves(meshes.size());
    for (std::size_t p = 0; p < pushes.size(); ++p) {
      const Push& push = pushes[p];
      left_mm[p / 2] = p % 2 == 0 ? push.deepest_mm : std::max(left_mm[p / 2], push.deepest_mm);
      if (push.deepest_mm <= 0) continue;
      Push& move = moves[pairs[p / 2][p % 2]];
      if (move.by.rows() == 0) {
        move = push;
        continue;
      }
      for (Eigen::Index v = 0; v < move.mm.size(); ++v)
        if (push.mm[v] > 0) {
          move.by.row(v) += push.by.row(v);
          move.mm[v] = std::max(move.mm[v], push.mm[v]);
        }
    }
    if (round == most_rounds || std::ranges::all_of(left_mm, [](double mm) { return mm <= at_rest_mm; })) break;
    double sum_mm = 0;
    for (const double mm : left_mm) sum_mm += std::max(0.0, mm);
    since_gain = sum_mm < (1 - least_gain) * least_mm ? 0 : since_gain + 1;
    least_mm = std::min(least_mm, sum_mm);
    if (since_gain == patient_rounds) break;
    std::vector<double> moved_mm(meshes.size());
    for_each_in_parallel(meshes.size(), [&](std::size_t k) {
      if (moves[k].by.rows() == 0 || moves[k].mm.maxCoeff() <= 0) return;
      if (!steps[k]) steps[k].emplace(meshes[k]);
      moved_mm[k] = go_out(meshes[k], moves[k], edge_mm[k], *steps[k]);
    });
    if (std::ranges::all_of(moved_mm, [](double mm) { return mm <= hardly_moved_mm; })) break;
  }
  return left_mm;
}

}  // namespace homolog
