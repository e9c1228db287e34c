#include "core/template_making/tunnels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <queue>

#include "core/mesh/voxels/cube_cases.h"
#include "core/template_making/distance_map.h"
#include "core/template_making/voxel_components.h"

namespace homolog {
namespace {

constexpr std::uint32_t all_but_middle = 0x7FFFFFFU & ~(1U << 13);

/// For each of the 27 voxels of a neighbourhood the others that touch it.
std::array<std::uint32_t, 27> touching_masks(int most_steps) {
  std::array<std::uint32_t, 27> masks{};
  for (int a = 0; a < 27; ++a)
    for (int b = 0; b < 27; ++b) {
      const int steps = std::abs(a % 3 - b % 3) + std::abs(a / 3 % 3 - b / 3 % 3) + std::abs(a / 9 - b / 9);
      const int farthest =
          std::max({std::abs(a % 3 - b % 3), std::abs(a / 3 % 3 - b / 3 % 3), std::abs(a / 9 - b / 9)});
      if (a != b && farthest == 1 && steps <= most_steps) masks[a] |= 1U << b;
    }
  return masks;
}

const std::array<std::uint32_t, 27> by_faces = touching_masks(1), by_edges = touching_masks(2);

std::uint32_t grown(std::uint32_t set, const std::array<std::uint32_t, 27>& touching) {
  std::uint32_t result = set;
  for (std::uint32_t rest = set; rest != 0; rest &= rest - 1) result |= touching[std::countr_zero(rest)];
  return result;
}

bool is_one_part(std::uint32_t set, const std::array<std::uint32_t, 27>& touching) {
  if (set == 0) return false;
  std::uint32_t part = set & (~set + 1);
  while (true) {
    const std::uint32_t next = grown(part, touching) & set;
    if (next == part) return part == set;
    part = next;
  }
}

/// A set of voxels with what its surface needs.
class Solid {
 public:
  Solid(std::vector<std::uint8_t> inside, const std::array<int, 3>& dims)
      : inside_(std::move(inside)),
        dims_(dims),
        row_(static_cast<std::size_t>(dims[0])),
        slice_(row_ * static_cast<std::size_t>(dims[1])) {}

  void flip(std::size_t v) { inside_[v] ^= 1; }
  const std::array<int, 3>& dims() const { return dims_; }
  const std::vector<std::uint8_t>& inside() const { return inside_; }

  bool on_rim(std::size_t v) const {
    const std::size_t i = v % row_, j = v % slice_ / row_, k = v / slice_;
    return i == 0 || j == 0 || k == 0 || i + 1 == row_ || j + 1 == static_cast<std::size_t>(dims_[1]) ||
           k + 1 == static_cast<std::size_t>(dims_[2]);
  }
  std::uint32_t neighbourhood(std::size_t v) const {
    std::uint32_t bits = 0;
    int bit = 0;
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t j = 0; j < 3; ++j)
        for (std::size_t i = 0; i < 3; ++i, ++bit)
          bits |= static_cast<std::uint32_t>(inside_[v + i - 1 + (j - 1) * row_ + (k - 1) * slice_]) << bit;
    return bits;
  }
  /// The 18 voxels that touch `v` by a face or an edge.
  std::array<std::size_t, 18> around(std::size_t v) const {
    std::array<std::size_t, 18> voxels{};
    std::size_t n = 0;
    for (std::uint32_t rest = by_edges[13]; rest != 0; rest &= rest - 1) {
      const auto bit = static_cast<std::size_t>(std::countr_zero(rest));
      voxels[n++] = v + bit % 3 - 1 + (bit / 3 % 3) * row_ - row_ + bit / 9 * slice_ - slice_;
    }
    return voxels;
  }
  std::array<std::size_t, 6> face_neighbours(std::size_t v) const {
    return {v - 1, v + 1, v - row_, v + row_, v - slice_, v + slice_};
  }

  /// Four times the Euler characteristic of the surface in the eight cubes around `v`.
  int euler_around(std::size_t v) const {
    int sum = 0;
    for (std::size_t corner = 0; corner < 8; ++corner)
      sum += euler_of_cube(v - (corner & 1U) - (corner >> 1 & 1U) * row_ - (corner >> 2) * slice_);
    return sum;
  }
  /// Four times the surface's Euler characteristic in the cube whose lowest corner is `v`: a vertex is shared by four
  /// cubes, and a triangle stands for half an edge less than its three.
  int euler_of_cube(std::size_t v) const {
    static const std::array<int, 256> table = [] {
      std::array<int, 256> entries{};
      for (unsigned cube = 0; cube < 256; ++cube) {
        int crossed = 0;
        for (unsigned a = 0; a < 8; ++a)
          for (unsigned axis = 0; axis < 3; ++axis)
            if ((a >> axis & 1U) == 0) crossed += (cube >> a & 1U) != (cube >> (a | 1U << axis) & 1U);
        entries[cube] = crossed - 2 * static_cast<int>(cube_cases().triangles[cube].size());
      }
      return entries;
    }();
    unsigned cube = 0;
    for (unsigned corner = 0; corner < 8; ++corner)
      cube |= static_cast<unsigned>(inside_[v + (corner & 1U) + (corner >> 1 & 1U) * row_ + (corner >> 2) * slice_])
              << corner;
    return table[cube];
  }
  /// Changes sides of voxels; returns how many tunnels of the surface that takes away (negative: makes), or parts it
  /// splits off.
  int flip(const std::vector<std::size_t>& voxels) {
    int change = 0;
    for (const std::size_t v : voxels) {
      change -= euler_around(v);
      inside_[v] ^= 1;
      change += euler_around(v);
    }
    return change / 8;
  }
  int genus() const {
    int euler = 0;
    for (std::size_t v = 0; v + slice_ + row_ + 1 < inside_.size(); ++v)
      if (v % row_ + 1 < row_ && v % slice_ / row_ + 1 < static_cast<std::size_t>(dims_[1])) euler += euler_of_cube(v);
    return 1 - euler / 8;
  }

 private:
  std::vector<std::uint8_t> inside_;
  std::array<int, 3> dims_;
  std::size_t row_, slice_;
};

/// Turns `from` into `body` voxel by voxel, those of high `urgency` first, as long as the topology stays. The voxels
/// that differ at the end hold the tunnels that only one of the two has, cut one voxel thick at the least urgent place;
/// gives the connected parts of these voxels.
std::vector<std::vector<std::size_t>> separators(const Solid& body, Solid from, const std::vector<float>& urgency) {
  using Entry = std::pair<float, std::size_t>;
  std::priority_queue<Entry> border;
  const auto differs = [&](std::size_t v) { return from.inside()[v] != body.inside()[v] && !from.on_rim(v); };
  for (std::size_t v = 0; v < urgency.size(); ++v) {
    if (!differs(v)) continue;
    const auto around = from.face_neighbours(v);
    const auto here = from.inside()[v];
    if (std::any_of(around.begin(), around.end(), [&](std::size_t n) { return from.inside()[n] != here; }))
      border.emplace(urgency[v], v);
  }
  while (!border.empty()) {
    const std::size_t v = border.top().second;
    border.pop();
    if (!differs(v) || !is_simple(from.neighbourhood(v))) continue;
    from.flip(v);
    for (const std::size_t n : from.around(v))
      if (differs(n)) border.emplace(urgency[n], n);
  }
  std::vector<std::uint8_t> left(urgency.size(), 0);
  for (std::size_t v = 0; v < left.size(); ++v) left[v] = differs(v);
  const auto parts = connected_components(left, body.dims(), Touching::faces_and_edges);
  std::vector<std::vector<std::size_t>> voxels(parts.sizes.size());
  for (std::size_t v = 0; v < parts.part.size(); ++v)
    if (parts.part[v] >= 0) voxels[parts.part[v]].push_back(v);
  return voxels;
}

Vec3 middle_of(const std::vector<std::size_t>& voxels, const VolumeGeometry& grid) {
  Vec3 sum = Vec3::Zero();
  for (const std::size_t v : voxels) {
    const auto n = static_cast<int>(v);
    sum += Vec3(n % grid.dims[0], n / grid.dims[0] % grid.dims[1], n / grid.dims[0] / grid.dims[1]);
  }
  return grid.to_mm(sum / static_cast<double>(voxels.size()));
}

/// The cuts of one kind that lie within `limit`.
struct Cuts {
  CutTunnel::How how = CutTunnel::How::filled;
  LevelSet limit;
  std::optional<double> width_mm;  ///< absent: each cut's own
};

/// All that lies within the box around a body.
LevelSet box_around(const LevelSet& distance) {
  const auto& dims = distance.grid().dims;
  std::array<int, 3> first = dims, last{};
  const auto for_each = [&](const auto& visit) {
    std::size_t v = 0;
    for (int k = 0; k < dims[2]; ++k)
      for (int j = 0; j < dims[1]; ++j)
        for (int i = 0; i < dims[0]; ++i) visit(std::array<int, 3>{i, j, k}, v++);
  };
  for_each([&](const std::array<int, 3>& at, std::size_t v) {
    if (!(distance.values()[v] < 0)) return;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      first[axis] = std::min(first[axis], at[axis]);
      last[axis] = std::max(last[axis], at[axis]);
    }
  });
  std::vector<float> values(distance.values().size());
  for_each([&](const std::array<int, 3>& at, std::size_t v) {
    int within = dims[0];  // voxels from the box's faces, negative outside
    for (std::size_t axis = 0; axis < 3; ++axis)
      within = std::min({within, at[axis] - first[axis], last[axis] - at[axis]});
    values[v] = static_cast<float>(-(within + 0.5) * distance.spacing_mm());
  });
  return {distance.grid(), std::move(values)};
}

/// The parts by how wide the tunnels are that they would close, and these widths.
std::vector<std::pair<double, std::vector<std::size_t>>> by_width(std::vector<std::vector<std::size_t>> parts,
                                                                  const LevelSet& distance) {
  std::vector<std::pair<double, std::vector<std::size_t>>> sorted;
  for (auto& part : parts) {
    double deepest_mm = 0;
    for (const std::size_t v : part)
      deepest_mm = std::max(deepest_mm, std::abs(static_cast<double>(distance.values()[v])));
    sorted.emplace_back(2 * deepest_mm, std::move(part));
  }
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

/// Makes cuts; says whether the surface has changed. `distance`: signed distances to the surface, whose own values need
/// not be distances.
bool cut_at(TunnelCut& cut, const LevelSet& distance, const Cuts& cuts, const TunnelLimits& limits) {
  const VolumeGeometry& grid = cut.surface.grid();
  const bool fill = cuts.how == CutTunnel::How::filled;
  const double sign = fill ? 1 : -1;
  std::vector<std::uint8_t> from = inside_of(cuts.limit);
  if (make_one_body(from, grid.dims).body == 0) return false;
  Solid body(inside_of(cut.surface), grid.dims);
  // Filled from what is far from the body to its surface, severed where it is thinnest.
  std::vector<float> urgency = distance.values();
  if (!fill)
    for (float& u : urgency) u = -u;

  std::vector<std::uint8_t> accepted(grid.voxels(), 0);
  const std::size_t before = cut.tunnels.size();
  for (const auto& [width_mm, part] :
       by_width(separators(body, Solid(std::move(from), grid.dims), urgency), distance)) {
    if (cut.genus <= limits.keep) break;
    const int gain = body.flip(part);
    if (gain <= 0 || cut.genus - gain < limits.keep) {  // a bridge, or more tunnels at once than asked for
      body.flip(part);
      continue;
    }
    cut.genus -= gain;
    for (const std::size_t v : part) accepted[v] = 1;
    cut.tunnels.push_back({cuts.how, middle_of(part, grid), cuts.width_mm.value_or(width_mm)});
  }
  if (cut.tunnels.size() == before) return false;

  // A value on the other side of zero, for a cut that reaches `reach_mm` to either side.
  const std::vector<float> from_cut = distance_to(accepted, grid);
  const auto cut_values = [&](double reach_mm) {
    std::vector<float> values = cut.surface.values();
    for (std::size_t v = 0; v < values.size(); ++v) {
      const double thick = std::max(from_cut[v] - reach_mm, sign * cuts.limit.values()[v]);
      const double value = std::min(sign * values[v], thick);
      values[v] = static_cast<float>(sign * (accepted[v] != 0 ? std::min(value, -0.1 * grid.spacing_mm[0]) : value));
    }
    LevelSet surface(grid, std::move(values));
    make_one_body(surface);
    return surface;
  };
  LevelSet surface = cut_values(limits.reach_mm);
  int genus = genus_of(inside_of(surface), grid.dims);
  if (genus > cut.genus) {  // the thick cut met something else: a thin one will do
    surface = cut_values(0);
    genus = genus_of(inside_of(surface), grid.dims);
  }
  cut.genus = genus;
  cut.surface = std::move(surface);
  return true;
}

}  // namespace

bool is_simple(std::uint32_t inside) {
  const std::uint32_t in = inside & all_but_middle, out = ~inside & all_but_middle;
  std::uint32_t near_in = by_faces[13] & in;
  near_in = grown(grown(near_in, by_faces) & in, by_faces) & in;
  std::uint32_t near_out = by_edges[13] & out;
  near_out = grown(near_out, by_edges) & out;
  return is_one_part(near_in, by_faces) && is_one_part(near_out, by_edges);
}

std::string count_of_tunnels(int genus) {
  return genus == 1 ? "one tunnel" : std::to_string(genus) + " tunnels";
}

int genus_of(const std::vector<std::uint8_t>& inside, const std::array<int, 3>& dims) {
  return Solid(inside, dims).genus();
}

TunnelCut cut_tunnels(const LevelSet& surface, const TunnelLimits& limits) {
  TunnelCut cut{surface, 0, 0, {}};
  cut.genus_before = cut.genus = genus_of(inside_of(surface), surface.grid().dims);
  const double widest_mm = std::max(limits.fill_below_mm, limits.sever_below_mm);
  const auto distances = [&cut] { return signed_distance(inside_of(cut.surface), cut.surface.grid()); };
  if (cut.genus <= limits.keep) return cut;
  LevelSet distance = distances();
  constexpr int most_widths = 200;
  double width_mm = std::min(limits.first_below_mm, widest_mm);
  for (int k = 0; k < most_widths && cut.genus > limits.keep; ++k, width_mm *= 1.4) {
    const double fill_mm = std::min(width_mm, limits.fill_below_mm),
                 sever_mm = std::min(width_mm, limits.sever_below_mm);
    using How = CutTunnel::How;
    if (fill_mm > 0 && cut_at(cut, distance, {How::filled, closed_by(distance, fill_mm / 2), fill_mm}, limits))
      distance = distances();
    if (cut.genus > limits.keep && sever_mm > 0 &&
        cut_at(cut, distance, {How::severed, opened_by(distance, sever_mm / 2), sever_mm}, limits))
      distance = distances();
    if (width_mm >= widest_mm) break;
  }
  if (limits.fill_any && cut.genus > limits.keep)
    cut_at(cut, distance, {CutTunnel::How::filled, box_around(distance), std::nullopt}, limits);
  return cut;
}

}  // namespace homolog
