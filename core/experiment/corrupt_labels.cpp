#include "core/experiment/corrupt_labels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "core/base/numbers/index.h"
#include "core/base/numbers/random.h"
#include "core/structures/naming/level_names.h"
#include "core/structures/template_set.h"
#include "core/volume/labels/label_boxes.h"

namespace homolog {

namespace {

/// A label map to change, voxel by voxel.
class Changing {
 public:
  Changing(const VolumeRead& map, int value, std::uint64_t seed)
      : map_(map), value_(value), random_(seed), grid_(map.volume.geometry), labels_(grid_.voxels()) {
    std::visit(
        [&](const auto& voxels) {
          for (std::size_t v = 0; v < labels_.size(); ++v) labels_[v] = rounded_label(voxels[v]);
        },
        map.volume.data);
    before_ = labels_;
  }

  Result<void> make(DefectKind kind);
  bool is_changed() const { return labels_ != before_; }
  CorruptedLabels result();

 private:
  std::string name_of(int value) const {
    const Segment* known = map_.segmentation.find(value);
    return known != nullptr && !known->name.empty() ? known->name : "label " + std::to_string(value);
  }
  Vec3 at(std::size_t voxel) const {
    const auto row = index(grid_.dims[0]), plane = row * index(grid_.dims[1]);
    return grid_.to_mm(Vec3(static_cast<double>(voxel % row), static_cast<double>(voxel % plane / row),
                            static_cast<double>(voxel / plane)));
  }
  std::vector<std::size_t> voxels_of(int value) const {
    std::vector<std::size_t> found;
    for (std::size_t v = 0; v < labels_.size(); ++v)
      if (labels_[v] == value) found.push_back(v);
    return found;
  }
  Vec3 middle_of(int value) const {
    Vec3 sum = Vec3::Zero();
    const auto voxels = voxels_of(value);
    for (const std::size_t v : voxels) sum += at(v);
    return sum / static_cast<double>(std::max<std::size_t>(1, voxels.size()));
  }
  Vec3 any_direction() {
    Vec3 way;
    do way = Vec3(random_.uniform(-1, 1), random_.uniform(-1, 1), random_.uniform(-1, 1));
    while (way.norm() > 1 || way.norm() < 0.1);
    return way.normalized();
  }
  /// The label whose middle is nearest, of those whose boxes come within 8 mm; 0: none.
  int neighbour();
  /// Gives the share of a label that lies farthest along `way` another label.
  void relabel_end(int from, int to, const Vec3& way, double share);
  /// Gives background within `radius_mm` of a line a label, or a label's voxels background.
  void relabel_bar(const Vec3& from, const Vec3& to, double radius_mm, int old_label, int new_label);
  void add(const std::string& structure, DefectKind kind, const std::string& with = {}) {
    planted_.push_back({structure, {kind, with}});
  }

  Result<void> shift_levels();
  Result<void> exchange_sides();
  void cut();

  const VolumeRead& map_;
  int value_;
  Random random_;
  VolumeGeometry grid_;
  std::vector<int> labels_, before_;
  std::map<int, std::string> new_names_;
  std::vector<PlantedDefect> planted_;
};

int Changing::neighbour() {
  constexpr double near_mm = 8;
  const auto boxes = label_boxes(map_.volume);
  const auto box_of = [&](const VoxelBox& voxels) {
    Box box;
    for (int corner = 0; corner < 8; ++corner) {
      const auto pick = [&](std::size_t a) { return (corner >> a & 1) != 0 ? voxels.last[a] : voxels.first[a]; };
      box.extend(grid_.to_mm(Vec3(pick(0), pick(1), pick(2))));
    }
    return box;
  };
  Box reach = box_of(boxes.at(value_));
  reach.min().array() -= near_mm;
  reach.max().array() += near_mm;
  const Vec3 own = middle_of(value_);
  std::vector<std::pair<double, int>> near;
  for (const auto& [label, box] : boxes)
    if (label != value_ && reach.intersects(box_of(box))) near.emplace_back((middle_of(label) - own).norm(), label);
  std::ranges::sort(near);
  if (near.empty()) return 0;
  return near[near.size() > 1 && random_.uniform() < 0.5 ? 1 : 0].second;
}

void Changing::relabel_end(int from, int to, const Vec3& way, double share) {
  auto voxels = voxels_of(from);
  std::vector<std::pair<double, std::size_t>> along;
  for (const std::size_t v : voxels) along.emplace_back(-way.dot(at(v)), v);
  std::ranges::sort(along);
  along.resize(static_cast<std::size_t>(share * static_cast<double>(along.size())));
  for (const auto& [height, v] : along) labels_[v] = to;
}

void Changing::relabel_bar(const Vec3& from, const Vec3& to, double radius_mm, int old_label, int new_label) {
  Box box;
  box.extend(from);
  box.extend(to);
  box.min().array() -= radius_mm;
  box.max().array() += radius_mm;
  const VoxelBox voxels = voxels_around(box, grid_, 1);
  const double length = std::max(1e-9, (to - from).squaredNorm());
  for (int k = voxels.first[2]; k <= voxels.last[2]; ++k)
    for (int j = voxels.first[1]; j <= voxels.last[1]; ++j)
      for (int i = voxels.first[0]; i <= voxels.last[0]; ++i) {
        const Vec3 p = grid_.to_mm(Vec3(i, j, k));
        const double t = std::clamp((p - from).dot(to - from) / length, 0.0, 1.0);
        int& label = labels_[grid_.index(i, j, k)];
        if (label == old_label && (p - from - t * (to - from)).norm() <= radius_mm) label = new_label;
      }
}

Result<void> Changing::shift_levels() {
  const auto own = level_in_name(name_of(value_));
  std::map<int, int> levels;  // levels of the same family, to labels
  for (const auto& [value, box] : label_boxes(map_.volume))
    if (const auto one = level_in_name(name_of(value)); one && own && one->family == own->family && !one->sacral)
      levels[one->level] = value;
  if (levels.size() < 3 || own->sacral) return fail("", "has no levels to shift");
  int by = random_.uniform() < 0.5 ? 1 : -1;
  // All of them, those from here on, or two that follow on each other.
  const double extent = random_.uniform();
  constexpr double all = 0.4, from_here = 0.8;
  if (extent >= from_here && !levels.contains(own->level + by)) by = -by;
  const auto moves = [&](int level) {
    if (extent < all) return by;
    if (extent < from_here) return (level - own->level) * by >= 0 ? by : 0;
    return level == own->level ? by : level == own->level + by ? -by : 0;
  };
  std::map<int, int> to;  // the new value of each label
  int fresh = 1 + label_boxes(map_.volume).rbegin()->first;
  for (const auto& [level, value] : levels) {
    if (moves(level) == 0) continue;
    const auto next = levels.find(level + moves(level));
    if (next == levels.end()) new_names_[fresh] = name_at_level(name_of(value), level + by);
    to[value] = next != levels.end() ? next->second : fresh++;
    add(name_of(value), DefectKind::level_shifted, next != levels.end() ? name_of(next->second) : std::string());
  }
  for (int& label : labels_)
    if (const auto found = to.find(label); found != to.end()) label = found->second;
  return {};
}

Result<void> Changing::exchange_sides() {
  const std::string other = name_of_other_side(name_of(value_));
  int partner = 0;
  for (const auto& [value, box] : label_boxes(map_.volume))
    if (!other.empty() && name_of(value) == other) partner = value;
  if (partner == 0) return fail("", "has no partner on the other side");
  for (int& label : labels_) label = label == value_ ? partner : label == partner ? value_ : label;
  add(name_of(value_), DefectKind::sides_exchanged, other);
  add(other, DefectKind::sides_exchanged, name_of(value_));
  return {};
}

void Changing::cut() {
  const VoxelBox box = label_boxes(map_.volume).at(value_);
  std::size_t axis = 0;  // the axis that runs most nearly along the body
  for (std::size_t a = 1; a < 3; ++a)
    if (std::abs(grid_.direction(2, static_cast<Eigen::Index>(a))) >
        std::abs(grid_.direction(2, static_cast<Eigen::Index>(axis))))
      axis = a;
  VoxelBox kept;
  for (std::size_t a = 0; a < 3; ++a) kept.last[a] = grid_.dims[a] - 1;
  const double share = random_.uniform(0.3, 0.7);
  const int at_slice = box.first[axis] + static_cast<int>(share * (box.last[axis] - box.first[axis]));
  // The side on which less of the map lies is cut away.
  if (at_slice > grid_.dims[axis] / 2)
    kept.last[axis] = at_slice;
  else
    kept.first[axis] = at_slice;
  Volume whole;
  whole.geometry = grid_;
  whole.data = std::vector<float>(labels_.begin(), labels_.end());
  const Volume part = cropped(whole, kept, 0);
  std::map<int, std::size_t> before, after;
  for (const int label : labels_) ++before[label];
  const auto& left = std::get<std::vector<float>>(part.data);
  labels_.assign(left.begin(), left.end());
  for (const int label : labels_) ++after[label];
  grid_ = part.geometry;
  for (const auto& [label, voxels] : before)
    if (label != 0 && after[label] > 0 && after[label] < voxels) add(name_of(label), DefectKind::cut_by_scan);
}

Result<void> Changing::make(DefectKind kind) {
  const std::string own = name_of(value_);
  const int with = neighbour();
  const bool needs_neighbour =
      kind == DefectKind::given_to_neighbour || kind == DefectKind::taken_from_neighbour || kind == DefectKind::doubled;
  if (needs_neighbour && with == 0) return fail("", own + " has no neighbour");
  const double size_mm = std::cbrt(static_cast<double>(voxels_of(value_).size()) * grid_.voxel_volume_mm3());
  const Vec3 middle = middle_of(value_);
  switch (kind) {
    case DefectKind::missing:
      relabel_end(value_, 0, Vec3::UnitZ(), 1);
      add(own, kind);
      break;
    case DefectKind::half_missing:
      relabel_end(value_, 0, any_direction(), random_.uniform(0.3, 0.55));
      add(own, kind);
      break;
    case DefectKind::given_to_neighbour:
    case DefectKind::taken_from_neighbour: {
      const int from = kind == DefectKind::given_to_neighbour ? value_ : with, to = from == value_ ? with : value_;
      const Vec3 way = (middle_of(to) - middle_of(from)).normalized() + 0.3 * any_direction();
      relabel_end(from, to, way.normalized(), random_.uniform(0.12, 0.4));
      add(name_of(from), DefectKind::given_to_neighbour, name_of(to));
      add(name_of(to), DefectKind::taken_from_neighbour, name_of(from));
      break;
    }
    case DefectKind::level_shifted:
      return shift_levels();
    case DefectKind::doubled:
      relabel_end(value_, with, Vec3::UnitZ(), 1);
      add(own, DefectKind::missing);
      add(name_of(with), kind, own);
      break;
    case DefectKind::bridge: {
      const Vec3 to = middle + any_direction() * size_mm * random_.uniform(1.2, 1.8);
      relabel_bar(middle, to, random_.uniform(0.06, 0.12) * size_mm, 0, value_);
      add(own, kind);
      break;
    }
    case DefectKind::hole: {
      const Vec3 way = any_direction() * size_mm * 0.7;
      const auto voxels = voxels_of(value_);
      const Vec3 through = at(voxels[static_cast<std::size_t>(random_.uniform() * static_cast<double>(voxels.size()))]);
      relabel_bar(through - way, through + way, random_.uniform(0.08, 0.14) * size_mm, value_, 0);
      add(own, kind);
      break;
    }
    case DefectKind::island: {
      const Vec3 there = middle + any_direction() * size_mm * random_.uniform(1.5, 2.5);
      relabel_bar(there, there + any_direction() * size_mm * 0.1, random_.uniform(0.1, 0.25) * size_mm, 0, value_);
      add(own, kind);
      break;
    }
    case DefectKind::sides_exchanged:
      return exchange_sides();
    case DefectKind::cut_by_scan:
      cut();
      break;
    case DefectKind::other:
      return fail("", "is no kind that can be made");
  }
  return {};
}

CorruptedLabels Changing::result() {
  CorruptedLabels made;
  made.planted = std::move(planted_);
  Volume& volume = made.map.volume;
  volume.geometry = grid_;
  volume.range_max = static_cast<double>(*std::ranges::max_element(labels_));
  volume.data = std::vector<std::uint16_t>(labels_.begin(), labels_.end());
  made.map.segmentation = map_.segmentation;
  for (const auto& [value, name] : new_names_) made.map.segmentation.add({.name = name, .value = value});
  return made;
}

}  // namespace

Result<CorruptedLabels> corrupt_labels(const VolumeRead& map, int value, DefectKind kind, std::uint64_t seed) {
  if (!map.other_layers.empty()) return fail("", "holds layers; write it as one label map first");
  if (!label_boxes(map.volume).contains(value)) return fail("", "has no label " + std::to_string(value));
  Changing changing(map, value, seed);
  if (auto made = changing.make(kind); !made) return fail(made.error());
  if (!changing.is_changed()) return fail("", "has no voxel there to change");
  return changing.result();
}

}  // namespace homolog
