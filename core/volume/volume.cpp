#include "core/volume/volume.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <random>
#include <span>
#include <type_traits>

#include "core/base/encoding/hash.h"

namespace homolog {
namespace {

std::array<Vec3, 8> corners(const VolumeGeometry& geometry, double margin_vox) {
  std::array<Vec3, 8> result;
  for (int c = 0; c < 8; ++c) {
    Vec3 voxel;
    for (int a = 0; a < 3; ++a) {
      const double last = geometry.dims[a] - 1;
      voxel[a] = (c >> a & 1) ? last + margin_vox : -margin_vox;
    }
    result[c] = geometry.to_mm(voxel);
  }
  return result;
}

std::size_t index_of(const VolumeGeometry& geometry, int i, int j, int k, int frame) {
  assert(i >= 0 && j >= 0 && k >= 0 && frame >= 0);
  assert(i < geometry.dims[0] && j < geometry.dims[1] && k < geometry.dims[2]);
  return static_cast<std::size_t>(frame) * geometry.voxels() + geometry.index(i, j, k);
}

constexpr std::size_t most_labels = 65535;

template <class T>
std::map<int, std::size_t> count_integers(const T* begin, std::size_t count) {
  constexpr int lowest = std::numeric_limits<T>::min();
  std::vector<std::size_t> counts(static_cast<std::size_t>(std::numeric_limits<T>::max() - lowest) + 1, 0);
  for (std::size_t i = 0; i < count; ++i) ++counts[begin[i] - lowest];
  std::map<int, std::size_t> labels;
  for (std::size_t c = 0; c < counts.size(); ++c) {
    const int value = static_cast<int>(c) + lowest;
    if (counts[c] > 0 && value != 0) labels.emplace_hint(labels.end(), value, counts[c]);
  }
  return labels;
}

/// Label maps saved as floats: values are rounded. Labels come in runs, so that the map is asked once a run.
std::map<int, std::size_t> count_floats(const float* begin, std::size_t count) {
  std::map<int, std::size_t> labels;
  for (std::size_t i = 0; i < count;) {
    std::size_t end = i + 1;
    while (end < count && begin[end] == begin[i]) ++end;
    if (const int label = rounded_label(begin[i]); label != 0) {
      if (const auto known = labels.find(label); known != labels.end())
        known->second += end - i;
      else if (labels.size() < most_labels)
        labels.emplace(label, end - i);
    }
    i = end;
  }
  return labels;
}

}  // namespace

bool VolumeGeometry::holds(const Vec3& p_mm) const {
  const Vec3 voxel = to_voxel(p_mm), last(dims[0] - 0.5, dims[1] - 0.5, dims[2] - 0.5);
  return (voxel.array() >= -0.5).all() && (voxel.array() <= last.array()).all();
}

Box VolumeGeometry::bounds_mm() const {
  Box box;
  for (const Vec3& corner : corners(*this, 0.5)) box.extend(corner);
  return box;
}

bool same_grid(const VolumeGeometry& a, const VolumeGeometry& b) {
  if (a.dims != b.dims) return false;
  const auto in_a = corners(a, 0), in_b = corners(b, 0);
  for (std::size_t c = 0; c < in_a.size(); ++c)
    if ((a.to_voxel(in_b[c]) - a.to_voxel(in_a[c])).cwiseAbs().maxCoeff() > 0.01) return false;
  return true;
}

std::string geometry_hash(const VolumeGeometry& geometry) {
  Hash hash;
  const auto add = [&hash](std::int64_t value) {
    for (int byte = 0; byte < 8; ++byte) hash.add(static_cast<std::uint64_t>(value) >> (8 * byte) & 0xff);
  };
  const auto add_rounded = [&add](double value) { add(std::llround(value * 1e4)); };
  for (const int n : geometry.dims) add(n);
  for (const double value : geometry.spacing_mm) add_rounded(value);
  for (const double value : geometry.origin_mm) add_rounded(value);
  for (const double value : geometry.direction.reshaped()) add_rounded(value);
  return hash.hex();
}

void unite_labels(Volume& label_map, std::span<const int> labels) {
  if (labels.size() < 2) return;
  std::visit(
      [&]<class T>(std::vector<T>& voxels) {
        const auto first = static_cast<T>(labels.front());
        for (T& voxel : voxels) {
          const auto value = static_cast<double>(voxel);
          if (std::any_of(labels.begin(), labels.end(), [&](int label) { return std::rint(value) == label; }))
            voxel = first;
        }
      },
      label_map.data);
}

const char* voxel_type_name(const VoxelData& data) {
  static constexpr std::array<const char*, 4> names{"uint8", "int16", "uint16", "float32"};
  return names[data.index()];
}

double Volume::at(int i, int j, int k, int frame) const {
  const std::size_t index = index_of(geometry, i, j, k, frame);
  return std::visit([index](const auto& values) { return static_cast<double>(values[index]); }, data);
}

double Volume::sample(const Vec3& p_mm, double outside, int frame) const {
  const Vec3 voxel = geometry.to_voxel(p_mm);
  std::array<int, 3> low, high;
  Vec3 part;
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    const int last = geometry.dims[axis] - 1;
    if (!(voxel[a] >= -0.5 && voxel[a] <= last + 0.5)) return outside;
    const double inside = std::clamp(voxel[a], 0.0, static_cast<double>(last));
    low[axis] = std::min(static_cast<int>(inside), std::max(last - 1, 0));
    high[axis] = std::min(low[axis] + 1, last);
    part[a] = inside - low[axis];
  }
  double value = 0;
  for (int c = 0; c < 8; ++c) {
    const bool i = c & 1, j = c & 2, k = c & 4;
    const double weight = (i ? part[0] : 1 - part[0]) * (j ? part[1] : 1 - part[1]) * (k ? part[2] : 1 - part[2]);
    if (weight > 0) value += weight * at(i ? high[0] : low[0], j ? high[1] : low[1], k ? high[2] : low[2], frame);
  }
  return value;
}

namespace {

/// About 260,000 finite values of a volume, ascending: enough to fix a 0.1 % tail to a few hundredths of it. Steps of
/// random length, since a fixed one would meet the same columns in every row.
template <class T>
std::vector<double> sorted_sample(const std::vector<T>& values) {
  constexpr std::size_t enough = std::size_t{1} << 18;
  const std::size_t step = values.size() / enough + 1;
  std::vector<double> sample;
  sample.reserve(values.size() / step + values.size() / step / 4);
  std::minstd_rand random;
  for (std::size_t i = 0; i < values.size(); i += step == 1 ? 1 : 1 + random() % (2 * step - 1))
    if (std::isfinite(static_cast<float>(values[i]))) sample.push_back(static_cast<double>(values[i]));
  std::sort(sample.begin(), sample.end());
  return sample;
}

double at_share(std::span<const double> sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

/// Hounsfield units: fat and air lie below zero, which no other modality stores.
bool looks_like_ct(std::span<const double> sorted) {
  return at_share(sorted, 0.02) < -100 && sorted.back() > 150;
}

}  // namespace

std::pair<double, double> default_window(const Volume& volume) {
  if (volume.file_window && volume.file_window->second > 0) {
    const auto [centre, width] = *volume.file_window;
    return {centre - width / 2, centre + width / 2};
  }
  const std::vector<double> sample = std::visit([](const auto& values) { return sorted_sample(values); }, volume.data);
  if (sample.empty()) return {0, 1};
  if (looks_like_ct(sample)) return {-160, 240};
  // What is brighter than the background decides the upper end: in an MR most voxels are air, and a few bright ones
  // lie far above all tissue.
  const double from = at_share(sample, 0.001), dark = at_share(sample, 0.02), bright = at_share(sample, 0.98);
  const auto tissue = std::upper_bound(sample.begin(), sample.end(), dark + 0.1 * (bright - dark));
  const double to = tissue == sample.end() ? bright : at_share({tissue, sample.end()}, 0.98);
  return {from, to > from ? to : from + 1};
}

std::map<int, std::size_t> labels_of(const Volume& label_map, int frame) {
  const std::size_t count = label_map.geometry.voxels(), first = static_cast<std::size_t>(frame) * count;
  return std::visit(
      [first, count](const auto& values) {
        using T = typename std::decay_t<decltype(values)>::value_type;
        if constexpr (std::is_integral_v<T>)
          return count_integers(values.data() + first, count);
        else
          return count_floats(values.data() + first, count);
      },
      label_map.data);
}

}  // namespace homolog
