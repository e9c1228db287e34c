#include "core/template_making/faced_part.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh/construction/clip.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/parts/patches.h"
#include "core/mesh/voxels/isosurface.h"

namespace homolog {

namespace {

bool is_one_of(const std::vector<int>& values, int value) {
  return std::ranges::find(values, value) != values.end();
}

/// How much of each kind lies at a place, 0…1 in all.
struct Shares {
  double label = 0, nothing = 0, faced = 0, other = 0;
};

/// The surroundings of a label in its map, between voxels too.
class Surroundings {
 public:
  Surroundings(const Volume& labels, int label, int frame, const FacedLabels& faced)
      : labels_(labels), label_(label), frame_(frame), faced_(faced) {}

  Shares at(const Vec3& p_mm) const {
    const Vec3 voxel = labels_.geometry.to_voxel(p_mm), low = voxel.array().floor();
    const Vec3 on = voxel - low;
    Shares shares;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 step(corner & 1, corner >> 1 & 1, corner >> 2);
      const double weight = (step.array() * on.array() + (1 - step.array()) * (1 - on.array())).prod();
      if (weight > 0) share_of(low + step, shares) += weight;
    }
    return shares;
  }

  /// The way through one voxel in a direction of length 1, mm.
  double voxel_mm(const Vec3& along) const {
    const auto& grid = labels_.geometry;
    return 1 / (grid.direction.transpose() * along).cwiseQuotient(grid.spacing_mm).norm();
  }

 private:
  double& share_of(const Vec3& voxel, Shares& shares) const {
    const auto& dims = labels_.geometry.dims;
    const auto i = static_cast<int>(voxel.x()), j = static_cast<int>(voxel.y()), k = static_cast<int>(voxel.z());
    if (i < 0 || j < 0 || k < 0 || i >= dims[0] || j >= dims[1] || k >= dims[2]) return shares.other;
    const int value = rounded_label(labels_.at(i, j, k, frame_));
    if (value == 0) return shares.nothing;
    if (value == label_ || label_ == every_label) return shares.label;
    return is_one_of(faced_.values, value) ? shares.faced : shares.other;
  }

  const Volume& labels_;
  int label_, frame_;
  const FacedLabels& faced_;
};

/// 1 where what lies beyond a place of the surface is faced, −1 where it is not, and between the two at its edge. Two
/// voxels are looked through: segmenters leave gaps between neighbours.
double facing(const Surroundings& around, const Vec3& p_mm, const Vec3& outward, bool faces_nothing) {
  const double step_mm = around.voxel_mm(outward) / 2;
  for (int step = 1; step <= 4; ++step) {
    const Shares shares = around.at(p_mm + step * step_mm * outward);
    const double neighbours = shares.faced + shares.other;
    if (neighbours > shares.nothing && neighbours > shares.label) return (shares.faced - shares.other) / neighbours;
  }
  return faces_nothing ? 1 : -1;
}

/// Each value becomes the mean of it and its neighbours', over about `radius_mm`.
VertexScalars evened(const Mesh& surface, VertexScalars values, double radius_mm) {
  const auto& edges = surface.topology->edges();
  double mean_mm = 0;
  for (const auto& [a, b] : edges) mean_mm += (surface.points.row(a) - surface.points.row(b)).norm();
  mean_mm /= static_cast<double>(edges.size());
  constexpr double fewest = 2, most = 100;
  const int rounds = static_cast<int>(std::clamp(std::ceil(std::pow(radius_mm / mean_mm, 2)), fewest, most));
  for (int round = 0; round < rounds; ++round) {
    const VertexScalars was = values;
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      const auto ring = surface.topology->one_ring(i);
      for (const std::int32_t other : ring) values[i] += was[other];
      values[i] /= static_cast<double>(ring.size() + 1);
    }
  }
  return values;
}

/// The patches of a surface that would be cut out, or would stay, each with its area.
std::vector<std::pair<std::vector<std::int32_t>, double>> patches_with_areas(const Mesh& surface,
                                                                             const VertexScalars& area_mm2,
                                                                             const VertexScalars& values, bool cut) {
  std::vector<char> marked(static_cast<std::size_t>(values.size()));
  for (Eigen::Index i = 0; i < values.size(); ++i) marked[i] = (values[i] >= 0) == cut;
  std::vector<std::pair<std::vector<std::int32_t>, double>> patches;
  for (auto& patch : patches_of(*surface.topology, std::move(marked))) {
    double mm2 = 0;
    for (const std::int32_t i : patch) mm2 += area_mm2[i];
    patches.emplace_back(std::move(patch), mm2);
  }
  return patches;
}

/// Small patches that would be cut out stay: they are holes, as between two valves, and no openings.
void keep_holes(const Mesh& surface, VertexScalars& values) {
  // Share of the largest opening, or of what stays if that is less. An outflow has a quarter of its ventricle's inflow.
  constexpr double hole_share = 0.05;
  const VertexScalars area_mm2 = vertex_areas_mm2(surface);
  const auto largest = [](const auto& patches) {
    double most = 0;
    for (const auto& patch : patches) most = std::max(most, patch.second);
    return most;
  };
  const auto cut = patches_with_areas(surface, area_mm2, values, true);
  const double least_mm2 =
      hole_share * std::min(largest(cut), largest(patches_with_areas(surface, area_mm2, values, false)));
  for (const auto& [patch, mm2] : cut)
    if (mm2 < least_mm2)
      for (const std::int32_t i : patch) values[i] = -1;
}

}  // namespace

Result<Mesh> faced_part(const Mesh& surface, const Volume& labels, int label, int frame, const FacedLabels& faced) {
  const Surroundings around(labels, label, frame, faced);
  const Points normals = vertex_normals(surface);
  const bool faces_nothing = is_one_of(faced.values, 0);
  VertexScalars values(surface.points.rows());
  double voxel_mm = 0;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const Vec3 outward = normals.row(i).transpose();
    values[i] = -facing(around, surface.points.row(i).transpose(), outward, faces_nothing) * (faced.kept ? 1 : -1);
    voxel_mm += around.voxel_mm(outward) / static_cast<double>(values.size());
  }
  values = evened(surface, std::move(values), 2 * voxel_mm);
  keep_holes(surface, values);
  constexpr double off = 0.03;  // a cut that all but meets a vertex would leave slivers
  for (double& value : values) value = value < 0 ? std::min(value, -off) : std::max(value, off);
  const auto part = clipped(surface, values);
  const auto fails = [&](bool none) {
    return fail("", label_name(label) + (none ? " faces none of the labels that are named; name its neighbours"
                                              : " faces the labels that are named and no others; name some of them"));
  };
  if (!part) return fails(faced.kept);
  if (part->topology->closed()) return fails(!faced.kept);
  return *part;
}

std::optional<std::string> take_largest_piece(Mesh& part, int label) {
  constexpr double hardly_any = 0.01;
  const double whole_mm2 = surface_area_mm2(part);
  part = largest_part(part);
  const double left_out = 1 - surface_area_mm2(part) / whole_mm2;
  if (left_out < hardly_any) return std::nullopt;
  return "the part of " + label_name(label) + " is in several pieces; the largest was taken, and the others (" +
         std::to_string(std::lround(100 * left_out)) + " % of its area) are left out";
}

}  // namespace homolog
