#include "core/structures/repair.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "core/adapt/choose_closing.h"
#include "core/base/index.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/voxelise.h"
#include "core/placement/similarity_fit.h"
#include "core/structures/name_levels.h"
#include "core/structures/neighbours_say.h"
#include "core/structures/structure_confidence.h"
#include "core/structures/voxel_body.h"
#include "core/volume/label_boxes.h"

namespace homolog {

namespace {

/// From which share of the voxels something counts; sound structures stay below [docs/measurements/repair.md].
constexpr double some_islands = 0.0005, some_holes = 0.003, some_bridges = 0.0025, much_lost = 0.05,
                 much_lacking = 0.15, much_beyond = 0.05, some_at_border = 0.002, much_smaller = 0.2, usual_dice = 0.98,
                 no_hole = 0.1, no_bridge = 0.15, hardly_dice = 0.85, near_share = 0.1;

/// The work on one map.
class Repair {
 public:
  Repair(const SetOfTemplates& set, VolumeRead& map, int frame, RepairedMap& result)
      : set_(set),
        map_(map),
        frame_(frame),
        result_(result),
        expected_(expected_shapes(set, result.subject, result.fitted)),
        shapes_(expected_.size()) {
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
      if (!result_.subject.structures[k].is_there()) find_missing(k);
    }
    for (std::size_t k = 0; k < result_.structures.size(); ++k)
      if (result_.fitted.structures[k].fit && expected_[k]) find_lost(k);
    for (std::size_t k = 0; k < result_.structures.size(); ++k)
      if (result_.fitted.structures[k].fit) find_in(k);
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
  bool has(std::size_t k, DefectKind kind) const {
    const auto& defects = result_.structures[k].defects;
    return std::ranges::any_of(defects, [&](const Defect& known) { return known.kind == kind; });
  }
  /// Whether the map has a vertebra of that level.
  bool has_level(int level) const {
    for (std::size_t k = 0; k < set_.set.structures.size(); ++k)
      if (level_of_name(name(k)) == level && result_.subject.structures[k].is_there()) return true;
    return false;
  }
  const std::string& name(std::size_t k) const { return set_.set.structures[k].name; }
  Vec3 middle(std::size_t k) const { return result_.fitted.structures[k].fit->mesh.points.colwise().mean(); }

  /// The volume that has a structure, and its first voxel of the frame.
  std::pair<Volume*, std::size_t> voxels_of(std::size_t k);
  /// Of a sign, what is left where other changes have mended some of its voxels.
  double share_left(std::size_t k, double share, const std::vector<VoxelChange>& changes);
  /// Changes the voxels that still have the label that they had.
  void change(std::size_t k, const std::vector<VoxelChange>& changes);
  void find_exchanged_sides();
  void find_shifted_levels();
  void find_in(std::size_t k);
  /// What a structure has lost, to a neighbour or to nobody.
  void find_lost(std::size_t k);
  void find_missing(std::size_t k);
  /// How a structure should be: its template fitted to what there is of it. Null: nobody knows.
  const Mesh* shape(std::size_t k);
  /// Gives voxels without a label that of a structure.
  void fill(std::size_t k, const Neighbourhood& there, const std::function<bool(std::size_t)>& is_its);
  void fill_up(std::size_t k);
  /// Gives a structure what another one has of it.
  void take_back(std::size_t k, std::size_t other);

  const SetOfTemplates& set_;
  VolumeRead& map_;
  int frame_;
  RepairedMap& result_;
  std::vector<std::optional<Mesh>> expected_, shapes_;
  bool shifted_ = false;  ///< all levels are named one off
};

std::pair<Volume*, std::size_t> Repair::voxels_of(std::size_t k) {
  const std::size_t layer = result_.subject.structures[k].segment.layer;
  if (map_.other_layers.empty()) return {&map_.volume, map_.volume.geometry.voxels() * index(frame_)};
  return {layer == 0 ? &map_.volume : &map_.other_layers[layer - 1], 0};
}

double Repair::share_left(std::size_t k, double share, const std::vector<VoxelChange>& changes) {
  if (changes.empty()) return share;
  const auto [volume, first] = voxels_of(k);
  const auto left = std::visit(
      [&, start = first](const auto& voxels) {
        return std::ranges::count_if(
            changes, [&](const VoxelChange& one) { return rounded_label(voxels[start + one.voxel]) == one.from; });
      },
      volume->data);
  return share * static_cast<double>(left) / static_cast<double>(changes.size());
}

void Repair::change(std::size_t k, const std::vector<VoxelChange>& changes) {
  const auto [volume, first] = voxels_of(k);
  std::visit(
      [&, start = first](auto& voxels) {
        using Voxel = typename std::decay_t<decltype(voxels)>::value_type;
        for (const VoxelChange& one : changes) {
          Voxel& voxel = voxels[start + one.voxel];
          if (rounded_label(voxel) != one.from) continue;
          voxel = static_cast<Voxel>(one.to);
          ++result_.structures[k].changed_voxels;
        }
      },
      volume->data);
  volume->range_max = std::max(volume->range_max, static_cast<double>(result_.subject.structures[k].segment.value));
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
  constexpr double likely = 0.2;
  std::vector<char> sound(result_.structures.size());
  for (std::size_t k = 0; k < sound.size(); ++k) {
    const FittedStructure& one = result_.fitted.structures[k];
    const bool is_sound = one.fit && !one.judgement.doubtful && std::abs(result_.signs[k].volume) < much_smaller;
    sound[k] = is_sound ? 1 : 0;
  }
  const auto evidence = level_evidence(set_, result_.subject, sound);
  if (!evidence) return;
  for (std::size_t k = 0; k < set_.set.structures.size(); ++k) {
    const auto level = level_of_name(name(k));
    if (!level || !result_.subject.structures[k].is_there()) continue;
    result_.structures[k].p_named = std::min(result_.structures[k].p_named, evidence->p_as_named);
    shifted_ = evidence->p_as_named < likely;
    if (!shifted_) continue;
    const std::string other = name_at_level(name(k), *level + evidence->shift);
    add(k, DefectKind::level_shifted, other);
    result_.structures[k].proposed_name = other;
  }
}

void Repair::find_in(std::size_t k) {
  const StructureSigns& signs = result_.signs[k];
  if (share_left(k, signs.islands, signs.without_islands) >= some_islands) {
    add(k, DefectKind::island);
    change(k, signs.without_islands);
  }
  if (signs.at_border > some_at_border) add(k, DefectKind::cut_by_scan);
  if (!expected_[k] && result_.fitted.structures[k].judgement.doubtful) return;  // with what to compare it?
  if (has(k, DefectKind::half_missing) || has(k, DefectKind::doubled)) return;
  // A fit that does not reach everything leaves more outside, and more within.
  const double misfit = std::max(0.0, usual_dice - result_.fitted.structures[k].judgement.inside_scan.dice);
  const double holes_from = some_holes + misfit / 4, bridges_from = some_bridges + misfit / 2;
  const double holes = share_left(k, signs.holes, signs.without_holes),
               bridges = share_left(k, signs.bridges, signs.without_bridges);
  if (holes >= holes_from && holes < no_hole) {
    add(k, DefectKind::hole);
    change(k, signs.without_holes);
  }
  if (bridges >= bridges_from && bridges < no_bridge) {
    add(k, DefectKind::bridge);
    change(k, signs.without_bridges);
  }
  const bool is_unlike =
      holes >= no_hole || bridges >= no_bridge || result_.fitted.structures[k].judgement.inside_scan.dice < hardly_dice;
  if (is_unlike && result_.structures[k].defects.empty()) add(k, DefectKind::other);
}

void Repair::find_lost(std::size_t k) {
  const StructureSigns& signs = result_.signs[k];
  bool lost = false;
  for (const auto& [other, share] : signs.lost_to) {
    if (share < much_lost) continue;
    lost = true;
    add(k, DefectKind::given_to_neighbour, name(other));
    add(other, DefectKind::taken_from_neighbour, name(k));
    take_back(k, other);
  }
  if (lost || signs.beyond > much_beyond || signs.lacking < much_lacking || signs.volume > -much_smaller) return;
  add(k, DefectKind::half_missing);
  fill_up(k);
}

void Repair::find_missing(std::size_t k) {
  constexpr double whole = 0.6, much_of_it = 0.25, much_larger = 0.3, room = 0.4;
  if (!expected_[k]) return;
  const auto [layer, of_layer] = layer_of(map_, result_.subject.structures[k].segment.layer, frame_);
  const Neighbourhood there = around(bounds_of(expected_[k]->points), *layer, of_layer, 1);
  const auto inside = voxelise(*expected_[k], there.grid);
  const double all = 1000 * std::abs(enclosed_volume_ml(*expected_[k])) / there.grid.voxel_volume_mm3();
  std::map<int, double> held;
  double voxels = 0;
  for (std::size_t v = 0; v < inside.size(); ++v)
    if (inside[v] != 0) held[there.labels[v]] += 1 / all, voxels += 1;
  if (voxels < whole * all) return;  // it would lie outside of the scan
  std::size_t doubled = k;
  for (std::size_t other = 0; other < result_.structures.size(); ++other) {
    const StructureInMap& theirs = result_.subject.structures[other];
    const bool is_too_large =
        result_.fitted.structures[other].judgement.doubtful || result_.signs[other].volume > much_larger;
    if (!theirs.is_there() || !is_too_large || held[theirs.segment.value] < much_of_it) continue;
    if (doubled == k || held[theirs.segment.value] > held[result_.subject.structures[doubled].segment.value])
      doubled = other;
  }
  if (doubled != k) {
    add(k, DefectKind::missing);
    add(doubled, DefectKind::doubled, name(k));
    // Its own form tells nothing while it has two bodies.
    if (const auto said = said_by_neighbours(set_, result_.fitted.structures, doubled))
      shapes_[doubled] = Mesh{set_.templates[doubled]->topology, said->apply(set_.templates[doubled]->points)};
    shapes_[k] = expected_[k];
    take_back(k, doubled);
    return;
  }
  // Where others are, there is no room: not everybody has it.
  if (held[0] < room) return;
  add(k, DefectKind::missing);
  // At the end of a spine the names may as well be a level off.
  const auto level = level_of_name(name(k));
  if (level && shifted_ && !(has_level(*level - 1) && has_level(*level + 1))) return;
  shapes_[k] = expected_[k];
  fill(k, there, [&](std::size_t v) { return inside[v] != 0; });
}

const Mesh* Repair::shape(std::size_t k) {
  if (shapes_[k]) return &*shapes_[k];
  const StructureInMap& there = result_.subject.structures[k];
  if (!expected_[k] || !there.is_there()) return expected_[k] ? &*expected_[k] : nullptr;
  const Template& own = *set_.templates[k];
  const int value = there.segment.value;
  const auto boundary =
      label_boundary(*there.mask, value, 0, usual_closing_mm(*there.mask, value, 0), own.points.rows(), {.all = true});
  shapes_[k] = expected_[k];
  if (!boundary) return &*shapes_[k];
  FitOptions options;
  options.partial = true;
  options.placement = nearest_similarity(own.points, expected_[k]->points, {});
  if (auto fit = fit_to_boundary(own, *boundary, options)) shapes_[k] = std::move(fit->mesh);
  return &*shapes_[k];
}

void Repair::fill(std::size_t k, const Neighbourhood& there, const std::function<bool(std::size_t)>& is_its) {
  const StructureInMap& own = result_.subject.structures[k];
  const auto [layer, of_layer] = layer_of(map_, own.segment.layer, frame_);
  std::vector<VoxelChange> changes;
  for (std::size_t v = 0; v < there.labels.size(); ++v)
    if (there.labels[v] == 0 && is_its(v))
      changes.push_back({there.voxel_of_map(v, layer->geometry), there.labels[v], own.segment.value});
  change(k, changes);
}

void Repair::fill_up(std::size_t k) {
  constexpr double least_share = 0.01;
  const Mesh* mesh = shape(k);
  if (mesh == nullptr) return;
  const auto [layer, of_layer] = layer_of(map_, result_.subject.structures[k].segment.layer, frame_);
  const Neighbourhood there = around(bounds_of(mesh->points), *layer, of_layer, 3);
  const auto inside = voxelise(*mesh, there.grid);
  const Body own(voxels_with(there.labels, result_.subject.structures[k].segment.value), there.grid);
  // What is missing is thick; a layer of a voxel around what is there is only how the mesh lies.
  const double thick_mm = 1.5 * there.grid.spacing_mm.maxCoeff();
  std::vector<std::uint8_t> core(inside.size());
  for (std::size_t v = 0; v < inside.size(); ++v)
    core[v] = inside[v] != 0 && there.labels[v] == 0 && own.to[v] > thick_mm ? 1 : 0;
  core = large_parts(std::move(core), there.grid, least_share * static_cast<double>(own.voxels));
  const Body missing(std::move(core), there.grid);
  fill(k, there, [&](std::size_t v) { return inside[v] != 0 && missing.to[v] <= 1.5 * thick_mm; });
}

void Repair::take_back(std::size_t k, std::size_t other) {
  constexpr double least_share = 0.01;
  const Mesh *mesh = shape(k), *theirs = expected_[other] ? &*expected_[other] : shape(other);
  if (has(other, DefectKind::doubled)) theirs = shape(other);
  if (mesh == nullptr) return;
  const StructureInMap& own = result_.subject.structures[k];
  const auto [layer, of_layer] = layer_of(map_, own.segment.layer, frame_);
  Box reach = bounds_of(mesh->points);
  reach.extend(bounds_of(expected_[k]->points));
  const Neighbourhood there = around(reach, *layer, of_layer, 3);
  // A fit to what is left may end there, where the expected form goes on.
  const Body fit(voxelise(*mesh, there.grid), there.grid), expected(voxelise(*expected_[k], there.grid), there.grid);
  const std::optional<Body> rest =
      theirs != nullptr ? std::optional<Body>(std::in_place, voxelise(*theirs, there.grid), there.grid) : std::nullopt;
  const int label = result_.subject.structures[other].segment.value;
  const double near_mm = std::max(1.5 * there.grid.spacing_mm.maxCoeff(),
                                  near_share * std::cbrt(1000 * std::abs(enclosed_volume_ml(*expected_[k]))));
  std::vector<std::uint8_t> back(there.labels.size());
  for (std::size_t v = 0; v < back.size(); ++v) {
    const double mm = std::min(fit.signed_mm(v), expected.signed_mm(v));
    back[v] = there.labels[v] == label && mm < near_mm && mm < (rest ? rest->signed_mm(v) : 0) ? 1 : 0;
  }
  back = large_parts(std::move(back), there.grid, least_share * static_cast<double>(expected.voxels));
  std::vector<VoxelChange> changes;
  for (std::size_t v = 0; v < back.size(); ++v)
    if (back[v] != 0) changes.push_back({there.voxel_of_map(v, layer->geometry), there.labels[v], own.segment.value});
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
