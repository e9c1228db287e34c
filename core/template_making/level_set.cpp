#include "core/template_making/level_set.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/base/numbers/index.h"
#include "core/mesh/voxels/isosurface.h"
#include "core/template_making/distance_map.h"

namespace homolog {
namespace {

/// Trilinear weights of a place in one axis: the lower of the two voxels and the share of the upper one.
struct Between {
  int lower;
  double share;
};

Between between(double at, int size) {
  const double inside = std::clamp(at, 0.0, size - 1.0);
  const int lower = std::min(static_cast<int>(inside), size - 2);
  return {lower, inside - lower};
}

std::vector<std::uint8_t> below(const LevelSet& surface, double limit_mm) {
  std::vector<std::uint8_t> set(surface.values().size());
  std::transform(surface.values().begin(), surface.values().end(), set.begin(),
                 [limit_mm](float value) { return static_cast<std::uint8_t>(value < limit_mm); });
  return set;
}

std::vector<std::uint8_t> complement(std::vector<std::uint8_t> set) {
  for (auto& voxel : set) voxel = voxel == 0;
  return set;
}

bool holds_any(const std::vector<std::uint8_t>& set) {
  return std::any_of(set.begin(), set.end(), [](std::uint8_t voxel) { return voxel != 0; });
}

}  // namespace

LevelSet::LevelSet(const VolumeGeometry& grid, std::vector<float> values) : grid_(grid), values_(std::move(values)) {
  assert(values_.size() == grid_.voxels() && *std::min_element(grid_.dims.begin(), grid_.dims.end()) > 1);
  to_voxel_ = (grid_.direction * grid_.spacing_mm.asDiagonal()).inverse();
}

LevelSet::Sample LevelSet::sample(const Vec3& p_mm) const {
  const Vec3 at = to_voxel_ * (p_mm - grid_.origin_mm);
  const Between i = between(at[0], grid_.dims[0]), j = between(at[1], grid_.dims[1]), k = between(at[2], grid_.dims[2]);
  const std::size_t row = index(grid_.dims[0]), slice = row * index(grid_.dims[1]);
  const float* corner = values_.data() + index(k.lower) * slice + index(j.lower) * row + index(i.lower);
  double along_i[4], slope_i[4];
  for (std::size_t c = 0; c < 4; ++c) {
    const float* start = corner + (c & 1u) * row + (c >> 1) * slice;
    slope_i[c] = start[1] - start[0];
    along_i[c] = start[0] + i.share * slope_i[c];
  }
  const auto mix = [](double a, double b, double share) { return a + share * (b - a); };
  const double low = mix(along_i[0], along_i[1], j.share), high = mix(along_i[2], along_i[3], j.share);
  const Vec3 slope(mix(mix(slope_i[0], slope_i[1], j.share), mix(slope_i[2], slope_i[3], j.share), k.share),
                   mix(along_i[1] - along_i[0], along_i[3] - along_i[2], k.share), high - low);
  return {mix(low, high, k.share), to_voxel_.transpose() * slope};
}

Vec3 LevelSet::onto_surface(Vec3 p_mm) const {
  for (int round = 0; round < 10; ++round) {
    const auto [value, gradient] = sample(p_mm);
    if (std::abs(value) < 1e-4 * spacing_mm()) break;
    const double steepness = std::max(gradient.squaredNorm(), 0.1);
    const double step = std::clamp(value / steepness, -2 * spacing_mm(), 2 * spacing_mm());
    p_mm -= step * gradient;
  }
  return p_mm;
}

LevelSet signed_distance(const std::vector<std::uint8_t>& inside, const VolumeGeometry& grid) {
  // The zero of this difference lies halfway between the centres of neighbouring voxels, in every direction of the
  // grid, as the mask's 0.5 isosurface does.
  std::vector<float> distance = distance_to(inside, grid);
  const std::vector<float> depth = distance_to(complement(inside), grid);
  for (std::size_t v = 0; v < distance.size(); ++v) distance[v] -= depth[v];
  return {grid, std::move(distance)};
}

LevelSet resampled(const LevelSet& surface, double spacing_mm) {
  const VolumeGeometry& coarse = surface.grid();
  VolumeGeometry grid = coarse;
  grid.spacing_mm.setConstant(spacing_mm);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double length_mm = coarse.spacing_mm[static_cast<Eigen::Index>(axis)] * (coarse.dims[axis] - 1);
    grid.dims[axis] = std::max(2, static_cast<int>(std::ceil(length_mm / spacing_mm)) + 1);
  }
  std::vector<float> values;
  values.reserve(grid.voxels());
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i)
        values.push_back(static_cast<float>(surface.sample(grid.to_mm({1.0 * i, 1.0 * j, 1.0 * k})).value));
  return {grid, std::move(values)};
}

LevelSet closed_by(const LevelSet& surface, double radius_mm) {
  const std::vector<std::uint8_t> outside = complement(below(surface, radius_mm));
  if (radius_mm <= 0 || !holds_any(outside)) return surface;
  const std::vector<float> depth = distance_to(outside, surface.grid());
  std::vector<float> values = surface.values();
  // `outside` is known by its voxels only, that is to half a voxel: less than that is not filled.
  const double limit = radius_mm + 0.5 * surface.spacing_mm();
  for (std::size_t v = 0; v < values.size(); ++v) values[v] = std::min(values[v], static_cast<float>(limit - depth[v]));
  return {surface.grid(), std::move(values)};
}

LevelSet opened_by(const LevelSet& surface, double radius_mm) {
  const std::vector<std::uint8_t> core = below(surface, -radius_mm);
  if (radius_mm <= 0) return surface;
  if (!holds_any(core)) return {surface.grid(), std::vector<float>(surface.values().size(), 1.0F)};
  const std::vector<float> distance = distance_to(core, surface.grid());
  std::vector<float> values = surface.values();
  const double limit = radius_mm + 0.5 * surface.spacing_mm();
  for (std::size_t v = 0; v < values.size(); ++v)
    values[v] = std::max(values[v], static_cast<float>(distance[v] - limit));
  return {surface.grid(), std::move(values)};
}

LevelSet smoothed(const LevelSet& surface, double sigma_mm) {
  return smoothed(surface, Vec3(Vec3::Constant(sigma_mm)));
}

namespace {

/// The weights of a Gaussian, at −reach … reach samples.
std::vector<float> gaussian_weights(double sigma) {
  const int reach = static_cast<int>(std::ceil(3 * sigma));
  std::vector<float> weights;
  for (int o = -reach; o <= reach; ++o) weights.push_back(static_cast<float>(std::exp(-0.5 * o * o / (sigma * sigma))));
  float sum = 0;
  for (const float weight : weights) sum += weight;
  for (float& weight : weights) weight /= sum;
  return weights;
}

}  // namespace

LevelSet smoothed(const LevelSet& surface, const Vec3& sigma_mm) {
  if (!(sigma_mm.maxCoeff() > 0)) return surface;
  const auto limit = static_cast<float>(4 * sigma_mm.maxCoeff());
  std::vector<float> values = surface.values(), line;
  for (float& value : values) value = std::clamp(value, -limit, limit);
  const auto& dims = surface.grid().dims;
  const std::array<std::size_t, 3> stride{1, index(dims[0]), index(dims[0]) * index(dims[1])};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
    const auto size = index(dims[axis]);
    const std::vector<float> weights =
        gaussian_weights(sigma_mm[static_cast<Eigen::Index>(axis)] / surface.spacing_mm());
    const int reach = static_cast<int>(weights.size() / 2);
    line.resize(size + 2 * index(reach));
    for (std::size_t ib = 0; ib < index(dims[b]); ++ib)
      for (std::size_t ia = 0; ia < index(dims[a]); ++ia) {
        float* start = values.data() + ia * stride[a] + ib * stride[b];
        for (std::size_t n = 0; n < size; ++n) line[n + index(reach)] = start[n * stride[axis]];
        std::fill_n(line.begin(), reach, line[reach]);
        std::fill_n(line.end() - reach, reach, line[size - 1 + index(reach)]);
        for (std::size_t n = 0; n < size; ++n) {
          float total = 0;
          for (std::size_t w = 0; w < weights.size(); ++w) total += weights[w] * line[n + w];
          start[n * stride[axis]] = total;
        }
      }
  }
  return {surface.grid(), std::move(values)};
}

LevelSet smoothed_near(const LevelSet& surface, double sigma_mm, const std::vector<Vec3>& places, double radius_mm) {
  const LevelSet smooth = smoothed(surface, sigma_mm);
  const VolumeGeometry& grid = surface.grid();
  std::vector<float> share(surface.values().size(), 0);
  for (const Vec3& place : places) {
    const Vec3 at = grid.to_voxel(place);
    const double reach = 2 * radius_mm / surface.spacing_mm();
    std::array<int, 3> first{}, last{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double middle = at[static_cast<Eigen::Index>(axis)];
      first[axis] = std::clamp(static_cast<int>(middle - reach), 0, grid.dims[axis] - 1);
      last[axis] = std::clamp(static_cast<int>(middle + reach), 0, grid.dims[axis] - 1);
    }
    for (int k = first[2]; k <= last[2]; ++k)
      for (int j = first[1]; j <= last[1]; ++j)
        for (int i = first[0]; i <= last[0]; ++i) {
          const double d = (Vec3(i, j, k) - at).norm() * surface.spacing_mm() / radius_mm;
          const double weight = d < 1 ? 1 : std::max(0.0, 2 - d);
          float& s = share[index(i) + index(grid.dims[0]) * (index(j) + index(grid.dims[1]) * index(k))];
          s = std::max(s, static_cast<float>(weight));
        }
  }
  std::vector<float> values = surface.values();
  for (std::size_t v = 0; v < values.size(); ++v) values[v] += share[v] * (smooth.values()[v] - values[v]);
  return {grid, std::move(values)};
}

OneBody make_one_body(LevelSet& surface) {
  std::vector<std::uint8_t> inside = inside_of(surface);
  const OneBody result = make_one_body(inside, surface.grid().dims);
  std::vector<float> values = surface.values();
  const auto beside = static_cast<float>(0.5 * surface.spacing_mm());
  for (std::size_t v = 0; v < values.size(); ++v)
    if ((values[v] < 0) != (inside[v] != 0)) values[v] = inside[v] != 0 ? -beside : beside;
  surface = LevelSet(surface.grid(), std::move(values));
  return result;
}

std::vector<std::uint8_t> inside_of(const LevelSet& surface) {
  return below(surface, 0);
}

Result<Mesh> surface_of(const LevelSet& surface) {
  return zero_surface(surface.values(), surface.grid());
}

}  // namespace homolog
