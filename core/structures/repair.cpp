#include "core/structures/repair.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/base/index.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/voxelise.h"
#include "core/structures/name_levels.h"
#include "core/structures/structure_confidence.h"
#include "core/volume/label_boxes.h"

namespace homolog {

namespace {

/// From which share of the voxels something counts; sound structures stay below [docs/measurements/repair.md].
constexpr double some_islands = 0.0005, some_holes = 0.003, some_bridges = 0.004, much_lost = 0.05, much_lacking = 0.2,
                 much_beyond = 0.02, much_smaller = 0.2, usual_dice = 0.98;

/// The work on one map.
class Repair {
 public:
  Repair(const SetOfTemplates& set, VolumeRead& map, int frame, RepairedMap& result)
      : set_(set),
        map_(map),
        frame_(frame),
        result_(result),
        expected_(expected_shapes(set, result.subject, result.fitted)) {
    result.signs = structure_signs(set, map, frame, result.subject, result.fitted, expected_);
    result.structures.resize(set.templates.size());
    for (std::size_t k = 0; k < result.structures.size(); ++k)
      result.structures[k].proposed_name = set.set.structures[k].name;
  }

  void find() {
    find_exchanged_sides();
    find_shifted_levels();
    for (std::size_t k = 0; k < result_.structures.size(); ++k) {
      if (set_.templates[k] == nullptr) continue;
      if (result_.subject.structures[k].is_there())
        find_in(k);
      else
        find_missing(k);
    }
    for (std::size_t k = 0; k < result_.structures.size(); ++k)
      result_.structures[k].confidence =
          structure_confidence(result_.fitted.structures[k], result_.signs[k], result_.structures[k]);
  }

 private:
  void add(std::size_t k, DefectKind kind, const std::string& with = {}) {
    auto& defects = result_.structures[k].defects;
    for (const Defect& known : defects)
      if (known.kind == kind && known.with == with) return;
    defects.push_back({kind, with});
  }
  const std::string& name(std::size_t k) const { return set_.set.structures[k].name; }
  Vec3 middle(std::size_t k) const { return result_.fitted.structures[k].fit->mesh.points.colwise().mean(); }

  void change(std::size_t k, const std::vector<VoxelChange>& changes);
  void find_exchanged_sides();
  void find_shifted_levels();
  void find_in(std::size_t k);
  void find_missing(std::size_t k);
  /// Fills voxels without a label in a mesh.
  void fill(std::size_t k, const Mesh& mesh);

  const SetOfTemplates& set_;
  VolumeRead& map_;
  int frame_;
  RepairedMap& result_;
  std::vector<std::optional<Mesh>> expected_;
};

void Repair::change(std::size_t k, const std::vector<VoxelChange>& changes) {
  const std::size_t layer = result_.subject.structures[k].segment.layer;
  Volume& volume = map_.other_layers.empty() || layer == 0 ? map_.volume : map_.other_layers[layer - 1];
  const std::size_t first = map_.other_layers.empty() ? volume.geometry.voxels() * index(frame_) : 0;
  std::visit(
      [&](auto& voxels) {
        using Voxel = typename std::decay_t<decltype(voxels)>::value_type;
        for (const VoxelChange& one : changes) {
          Voxel& voxel = voxels[first + one.voxel];
          if (voxel != static_cast<Voxel>(one.value)) ++result_.structures[k].changed_voxels;
          voxel = static_cast<Voxel>(one.value);
        }
      },
      volume.data);
  volume.range_max = std::max(volume.range_max, static_cast<double>(result_.subject.structures[k].segment.value));
}

void Repair::find_exchanged_sides() {
  for (std::size_t k = 0; k < set_.set.structures.size(); ++k) {
    const TemplateOfSet& one = set_.set.structures[k];
    if (one.side != Side::left || !result_.fitted.structures[k].fit) continue;
    for (std::size_t other = 0; other < set_.set.structures.size(); ++other) {
      if (name(other) != one.partner || !result_.fitted.structures[other].fit) continue;
      // x grows to the patient's left, in the set as in the map.
      const double in_set = (set_.templates[k]->points.col(0).mean() - set_.templates[other]->points.col(0).mean());
      const double in_map = (middle(k) - middle(other)).x();
      if (in_set * in_map >= 0) continue;
      add(k, DefectKind::sides_exchanged, name(other));
      add(other, DefectKind::sides_exchanged, name(k));
      result_.structures[k].proposed_name = name(other);
      result_.structures[other].proposed_name = name(k);
      result_.structures[k].p_named = result_.structures[other].p_named = 0.05;
    }
  }
}

void Repair::find_shifted_levels() {
  constexpr double likely = 0.5;
  const auto evidence = level_evidence(set_, result_.subject, result_.fitted);
  if (!evidence) return;
  for (std::size_t k = 0; k < set_.set.structures.size(); ++k) {
    const auto level = level_of_name(name(k));
    if (!level || !result_.subject.structures[k].is_there()) continue;
    result_.structures[k].p_named = std::min(result_.structures[k].p_named, evidence->p_as_named);
    if (evidence->p_as_named > likely) continue;
    const std::string other = name_at_level(name(k), *level + evidence->shift);
    add(k, DefectKind::level_shifted, other);
    result_.structures[k].proposed_name = other;
  }
}

void Repair::find_in(std::size_t k) {
  StructureSigns& signs = result_.signs[k];
  if (signs.islands >= some_islands) {
    add(k, DefectKind::island);
    change(k, signs.without_islands);
  }
  if (!expected_[k] && result_.fitted.structures[k].judgement.doubtful) return;  // with what to compare it?
  if (signs.holes >= some_holes) {
    add(k, DefectKind::hole);
    change(k, signs.without_holes);
  }
  bool lost = false;
  for (const auto& [other, share] : signs.lost_to) {
    if (share < much_lost) continue;
    lost = true;
    add(k, DefectKind::given_to_neighbour, name(other));
    add(other, DefectKind::taken_from_neighbour, name(k));
    change(k, signs.taken_back[other]);
  }
  if (signs.at_border && signs.beyond > much_beyond) {
    add(k, DefectKind::cut_by_scan);
  } else if (!lost && signs.lacking > much_lacking && signs.volume < -much_smaller) {
    add(k, DefectKind::half_missing);
    if (expected_[k]) fill(k, *expected_[k]);
  }
  // A fit that does not reach everything leaves more outside.
  const double misfit = std::max(0.0, usual_dice - result_.fitted.structures[k].judgement.inside_scan.dice);
  if (signs.bridges >= some_bridges + misfit / 2) {
    add(k, DefectKind::bridge);
    change(k, signs.without_bridges);
  }
}

void Repair::find_missing(std::size_t k) {
  constexpr double whole = 0.6;
  if (!expected_[k]) return;
  const Volume& volume = map_.volume;
  const VoxelBox box = voxels_around(bounds_of(expected_[k]->points), volume.geometry, 1);
  const VolumeGeometry grid = part_of_grid(volume.geometry, box);
  const auto inside = voxelise(*expected_[k], grid);
  const auto voxels = static_cast<double>(std::ranges::count(inside, std::uint8_t{1}));
  const double all = 1000 * std::abs(enclosed_volume_ml(*expected_[k])) / grid.voxel_volume_mm3();
  if (voxels < whole * all) return;
  add(k, DefectKind::missing);
  fill(k, *expected_[k]);
}

void Repair::fill(std::size_t k, const Mesh& mesh) {
  const std::size_t layer = result_.subject.structures[k].segment.layer;
  const auto [volume, of_layer] = layer_of(map_, layer, frame_);
  const VoxelBox box = voxels_around(bounds_of(mesh.points), volume->geometry, 1);
  const Volume part = cropped(*volume, box, 0, of_layer);
  const auto inside = voxelise(mesh, part.geometry);
  const auto& dims = volume->geometry.dims;
  std::vector<VoxelChange> changes;
  std::size_t at = 0;
  for (int z = box.first[2]; z <= box.last[2]; ++z)
    for (int y = box.first[1]; y <= box.last[1]; ++y)
      for (int x = box.first[0]; x <= box.last[0]; ++x, ++at)
        if (inside[at] != 0 && part.at(x - box.first[0], y - box.first[1], z - box.first[2]) == 0)
          changes.push_back({(index(z) * index(dims[1]) + index(y)) * index(dims[0]) + index(x),
                             result_.subject.structures[k].segment.value});
  change(k, changes);
}

}  // namespace

Result<RepairedMap> repair_map(const SetOfTemplates& set, VolumeRead& map, int frame, Progress* progress) {
  RepairedMap result;
  result.subject = find_in_map(set.set, map, frame);
  auto fitted = fit_set(set, result.subject, {0, progress});
  if (!fitted) return fail(fitted.error());
  result.fitted = std::move(*fitted);
  Repair(set, map, frame, result).find();
  return result;
}

}  // namespace homolog
