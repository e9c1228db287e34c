#include "core/structures/mend_structures.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "core/adapt/choose_closing.h"
#include "core/adapt/snap.h"
#include "core/base/index.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/voxelise.h"
#include "core/placement/similarity_fit.h"
#include "core/structures/level_names.h"
#include "core/structures/neighbours_say.h"
#include "core/structures/voxel_body.h"
#include "core/volume/label_boxes.h"

namespace homolog {

namespace {

// What the signs of a structure are compared with [StructureSigns]: shares of its voxels, unless something else is
// said. Sound structures stay below those from which something counts [docs/measurements/repair.md].

constexpr double some_islands = 0.0005;   ///< `islands`: from here on it has some
constexpr double large_island = 0.1;      ///< `islands`: from here on nobody knows which part is the right one
constexpr double some_holes = 0.003;      ///< `holes`: from here on it has some; more where the fit is worse
constexpr double no_hole = 0.1;           ///< `holes`: from here on it is something else
constexpr double some_tunnels = 0.0085;   ///< `tunnels`: from here on it has holes
constexpr double some_bridges = 0.0025;   ///< `bridges`: from here on it has some; more where the fit is worse
constexpr double no_bridge = 0.15;        ///< `bridges`: from here on it is something else
constexpr double some_bars = 0.004;       ///< `bars`: from here on it has bridges
constexpr double much_lost = 0.04;        ///< `lost_to`: from here on the neighbour has what it lost
constexpr double much_lacking = 0.15;     ///< `lacking`: from here on a part is missing, if it is much_smaller too
constexpr double surely_lacking = 0.2;    ///< `lacking`: from here on a part is missing
constexpr double much_smaller = 0.2;      ///< `volume`: from here on below 0
constexpr double much_beyond = 0.05;      ///< `beyond`: above, the end of the map says why it lacks something
constexpr double mostly_beyond = 0.5;     ///< `beyond`: above, it is not said to have lost something to a neighbour
constexpr double some_at_border = 0.002;  ///< `at_border`: above, the scan cuts it
constexpr double usual_dice = 0.98;       ///< of a fit with the map: what it is below, it is worse by
constexpr double hardly_dice = 0.85;      ///< of a fit with the map: below, something is wrong
constexpr double near_share = 0.1;        ///< of a structure's size: so far from its shape voxels are given back

/// The work on one map.
class Mending {
 public:
  Mending(const SetOfTemplates& set, VolumeRead& map, int frame, const MapRepairOptions& options, RepairedMap& result)
      : set_(set),
        map_(map),
        frame_(frame),
        options_(options),
        result_(result),
        expected_(result.expected),
        shapes_(expected_.size()) {}

  void find() {
    for (std::size_t k = 0; k < result_.structures.size(); ++k) {
      if (set_.templates[k] == nullptr) continue;
      if (!result_.subject.structures[k].is_there()) find_missing(k);
    }
    for (std::size_t k = 0; k < result_.structures.size(); ++k)
      if (result_.fitted.structures[k].fit && expected_[k]) find_lost(k);
    for (std::size_t k = 0; k < result_.structures.size(); ++k)
      if (result_.fitted.structures[k].fit) find_in(k);
    name_new();
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

  /// Gives the share of a set of voxels that has a structure's label outside of the shape that is expected of it.
  double share_beyond(std::size_t k, int label, const Neighbourhood& there, const std::vector<std::uint8_t>& of) const;
  /// The map as it is by now around a structure.
  Neighbourhood around_now(std::size_t k, const Box& reach, int margin) const {
    return around_structure(result_.subject, map_, frame_, k, reach, margin);
  }
  /// Takes from a structure of another layer what one has got of it.
  void take_from_layer(std::size_t k, std::size_t other, const std::vector<std::uint8_t>& taken,
                       const VolumeGeometry& grid);
  /// Names what has been filled in, where the map gives names.
  void name_new();
  /// The volume that has a structure, and its first voxel of the frame.
  std::pair<Volume*, std::size_t> voxels_of(std::size_t k);
  /// Of a sign, what is left where other changes have mended some of its voxels.
  double share_left(std::size_t k, double share, const std::vector<VoxelChange>& changes);
  /// Changes the voxels that still have the label that they had.
  void change(std::size_t k, const std::vector<VoxelChange>& changes);
  void find_in(std::size_t k);
  /// Whether a structure shows that something was added to it.
  bool has_too_much(std::size_t k) const {
    constexpr double some_islands_more = 0.03, some_volume_more = 0.1;
    const StructureSigns& signs = result_.signs[k];
    return signs.bars >= some_bars || signs.bridges >= some_bars || signs.islands >= some_islands_more ||
           signs.volume >= some_volume_more || result_.fitted.structures[k].judgement.doubtful;
  }
  /// What a structure has lost, to a neighbour or to nobody.
  void find_lost(std::size_t k);
  void find_missing(std::size_t k);
  /// How a structure should be: its template fitted to what there is of it. Null: nobody knows.
  const Mesh* shape(std::size_t k);
  /// A shape that others expect, drawn to the boundary that the image shows; itself where it shows too little.
  Mesh as_the_image_shows(std::size_t k, const Mesh& expected) const;
  /// Gives voxels without a label that of a structure.
  void fill(std::size_t k, const Neighbourhood& there, const std::function<bool(std::size_t)>& is_its);
  void fill_up(std::size_t k);
  /// Gives a structure what another one has of it.
  void take_back(std::size_t k, std::size_t other);

  const SetOfTemplates& set_;
  VolumeRead& map_;
  int frame_;
  const MapRepairOptions& options_;
  RepairedMap& result_;
  const std::vector<std::optional<Mesh>>& expected_;
  std::vector<std::optional<Mesh>> shapes_;
};

double Mending::share_beyond(std::size_t k, int label, const Neighbourhood& there,
                             const std::vector<std::uint8_t>& of) const {
  if (!expected_[k]) return 0;
  const auto own = voxelise(*expected_[k], there.grid);
  double all = 0, beyond = 0;
  for (std::size_t v = 0; v < of.size(); ++v) {
    if (of[v] == 0) continue;
    all += 1;
    if (own[v] == 0 && there.labels[v] == label) beyond += 1;
  }
  return all > 0 ? beyond / all : 0;
}

std::pair<Volume*, std::size_t> Mending::voxels_of(std::size_t k) {
  const std::size_t layer = result_.subject.structures[k].segment.layer;
  if (map_.other_layers.empty()) return {&map_.volume, map_.volume.geometry.voxels() * index(frame_)};
  return {layer == 0 ? &map_.volume : &map_.other_layers[layer - 1], 0};
}

double Mending::share_left(std::size_t k, double share, const std::vector<VoxelChange>& changes) {
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

void Mending::change(std::size_t k, const std::vector<VoxelChange>& changes) {
  const auto [volume, first] = voxels_of(k);
  const HeldByOthers held(result_.subject, map_, frame_, k);
  std::visit(
      [&, &grid = volume->geometry, start = first](auto& voxels) {
        using Voxel = typename std::decay_t<decltype(voxels)>::value_type;
        for (const VoxelChange& one : changes) {
          Voxel& voxel = voxels[start + one.voxel];
          if (rounded_label(voxel) != one.from) continue;
          if (one.from == 0 && held.label_at(place_of_voxel(grid, one.voxel)) != 0) continue;
          voxel = static_cast<Voxel>(one.to);
          ++result_.structures[k].changed_voxels;
        }
      },
      volume->data);
  volume->range_max = std::max(volume->range_max, static_cast<double>(result_.subject.structures[k].segment.value));
}

void Mending::take_from_layer(std::size_t k, std::size_t other, const std::vector<std::uint8_t>& taken,
                              const VolumeGeometry& grid) {
  if (label_around(result_.subject, k, other) >= 0) return;
  const auto [volume, first] = voxels_of(other);
  const VoxelBox box = voxels_around(grid.bounds_mm(), volume->geometry, 1);
  Volume gone;
  gone.geometry = grid;
  gone.data = taken;
  const VoxelGrid is_gone(gone);
  std::vector<VoxelChange> changes;
  for (int z = box.first[2]; z <= box.last[2]; ++z)
    for (int y = box.first[1]; y <= box.last[1]; ++y)
      for (int x = box.first[0]; x <= box.last[0]; ++x)
        if (is_gone.label_at(volume->geometry.to_mm(Vec3(x, y, z))) != 0)
          changes.push_back({volume->geometry.index(x, y, z), result_.subject.structures[other].segment.value, 0});
  change(other, changes);
}

void Mending::name_new() {
  auto& known = map_.segmentation;
  if (known.segments.empty()) return;
  for (std::size_t k = 0; k < result_.structures.size(); ++k)
    if (!result_.subject.structures[k].is_there() && result_.structures[k].changed_voxels > 0)
      known.add(result_.subject.structures[k].segment);
}

void Mending::find_in(std::size_t k) {
  const StructureSigns& signs = result_.signs[k];
  if (signs.at_border > some_at_border) add(k, DefectKind::cut_by_scan);
  // What the scan cuts may well lie in several parts, and of two bodies the smaller one may be the right one.
  const bool may_have_parts = has(k, DefectKind::cut_by_scan) || has(k, DefectKind::doubled);
  if (!may_have_parts && share_left(k, signs.islands, signs.without_islands) >= some_islands) {
    add(k, DefectKind::island);
    // Of two large parts nobody knows here which is the right one.
    if (signs.islands < large_island) change(k, signs.without_islands);
  }
  if (!expected_[k] && result_.fitted.structures[k].judgement.doubtful) return;  // with what to compare it?
  if (has(k, DefectKind::half_missing) || may_have_parts) return;
  // A fit that does not reach everything leaves more outside, and more within.
  const double misfit = std::max(0.0, usual_dice - result_.fitted.structures[k].judgement.inside_scan.dice);
  const double holes_from = some_holes + misfit / 4, bridges_from = some_bridges + misfit / 2;
  const double holes = share_left(k, signs.holes, signs.without_holes),
               bridges = share_left(k, signs.bridges, signs.without_bridges);
  const bool is_pierced = share_left(k, signs.tunnels, signs.without_holes) >= some_tunnels,
             has_bars = share_left(k, signs.bars, signs.without_bars) >= some_bars;
  if ((holes >= holes_from || is_pierced) && holes < no_hole) {
    add(k, DefectKind::hole);
    change(k, signs.without_holes);
  }
  if ((bridges >= bridges_from || has_bars) && bridges < no_bridge) {
    add(k, DefectKind::bridge);
    // What is thin is no part of the shape; of what is not, a fit may have left out some that is.
    change(k, has_bars ? signs.without_bars : signs.without_bridges);
  }
  const bool is_unlike =
      holes >= no_hole || bridges >= no_bridge || result_.fitted.structures[k].judgement.inside_scan.dice < hardly_dice;
  if (is_unlike && result_.structures[k].defects.empty()) add(k, DefectKind::other);
}

void Mending::find_lost(std::size_t k) {
  const StructureSigns& signs = result_.signs[k];
  bool lost = false;
  for (const auto& [other, share] : signs.lost_to) {
    if (share < much_lost || signs.beyond > mostly_beyond || !has_too_much(other)) continue;
    lost = true;
    add(k, DefectKind::given_to_neighbour, name(other));
    add(other, DefectKind::taken_from_neighbour, name(k));
    take_back(k, other);
  }
  if (lost || signs.beyond > much_beyond || signs.lacking < much_lacking) return;
  if (signs.lacking < surely_lacking && signs.volume > -much_smaller) return;
  add(k, DefectKind::half_missing);
  fill_up(k);
}

void Mending::find_missing(std::size_t k) {
  constexpr double whole = 0.6, much_of_it = 0.25, some_of_it = 0.05, two_bodies = 0.3, much_larger = 0.3,
                   much_beside = 0.15, much_beyond_itself = 0.5, room = 0.4;
  if (!expected_[k] || !result_.subject.structures[k].why_left_out.empty() || is_absent(result_.variants, k)) return;
  if (options_.model != nullptr)
    if (auto said = said_by_model(*options_.model, set_, result_.fitted.structures, k))
      result_.expected[k]->points = *said;
  const Neighbourhood there = around_now(k, bounds_of(expected_[k]->points), 1);
  const auto inside = voxelise(*expected_[k], there.grid);
  const double all = 1000 * std::abs(enclosed_volume_ml(*expected_[k])) / there.grid.voxel_volume_mm3();
  std::map<int, double> held;
  double voxels = 0;
  for (std::size_t v = 0; v < inside.size(); ++v)
    if (inside[v] != 0) held[there.labels[v]] += 1 / all, voxels += 1;
  if (voxels < whole * all) return;  // it would lie outside of the scan
  std::size_t doubled = k;
  for (std::size_t other = 0; other < result_.structures.size(); ++other) {
    const int label = label_around(result_.subject, k, other);
    const StructureSigns& signs = result_.signs[other];
    const double enough = signs.islands >= two_bodies ? some_of_it : much_of_it;
    if (!result_.subject.structures[other].is_there() || held[label] < enough) continue;
    const bool is_too_large = result_.fitted.structures[other].judgement.doubtful || signs.volume > much_larger ||
                              signs.bridges > much_beside;
    if (!is_too_large && share_beyond(other, label, there, inside) * voxels < much_beyond_itself * all) continue;
    if (doubled == k || held[label] > held[label_around(result_.subject, k, doubled)]) doubled = other;
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
  constexpr double sure = 0.45;
  double p_levels = 1;
  for (const RepairedStructure& one : result_.structures) p_levels = std::min(p_levels, one.p_named);
  const auto level = level_of_name(name(k));
  if (level && p_levels < sure && !(has_level(*level - 1) && has_level(*level + 1))) return;
  shapes_[k] = result_.expected[k] = as_the_image_shows(k, *expected_[k]);
  const Neighbourhood seen = around_now(k, bounds_of(shapes_[k]->points), 1);
  const auto body = voxelise(*shapes_[k], seen.grid);
  fill(k, seen, [&](std::size_t v) { return body[v] != 0; });
}

Mesh Mending::as_the_image_shows(std::size_t k, const Mesh& expected) const {
  constexpr double near_by_size = 0.2, hardly_seen = 0.2;
  if (options_.image == nullptr) return expected;
  const Eigen::Index count = expected.points.rows();
  SnapStart start{.mesh = expected,
                  .placed = expected.points,
                  .stiffness = set_.templates[k]->stiffness,
                  .free = VertexScalars::Ones(count)};
  Progress unseen, own(options_.progress != nullptr ? *options_.progress : unseen, 0);
  SnapOptions options;
  options.progress = &own;
  options.edges.reach_mm = near_by_size * std::cbrt(1000 * std::abs(enclosed_volume_ml(expected)));
  const auto drawn = snap(*options_.image, options_.image_frame, start, options);
  if (!drawn || drawn->mean_confidence < hardly_seen) return expected;
  return {expected.topology, drawn->points};
}

const Mesh* Mending::shape(std::size_t k) {
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
  if (options_.model != nullptr) options.allowed = options_.model->allowed[k];
  if (auto fit = fit_to_boundary(own, *boundary, options)) shapes_[k] = as_the_image_shows(k, fit->mesh);
  return &*shapes_[k];
}

void Mending::fill(std::size_t k, const Neighbourhood& there, const std::function<bool(std::size_t)>& is_its) {
  const StructureInMap& own = result_.subject.structures[k];
  const auto [layer, of_layer] = layer_of(map_, own.segment.layer, frame_);
  std::vector<VoxelChange> changes;
  for (std::size_t v = 0; v < there.labels.size(); ++v)
    if (there.labels[v] == 0 && is_its(v))
      changes.push_back({there.voxel_of_map(v, layer->geometry), there.labels[v], own.segment.value});
  change(k, changes);
}

void Mending::fill_up(std::size_t k) {
  constexpr double least_share = 0.01;
  const Mesh* mesh = shape(k);
  if (mesh == nullptr) return;
  const Neighbourhood there = around_now(k, bounds_of(mesh->points), 3);
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

void Mending::take_back(std::size_t k, std::size_t other) {
  constexpr double least_share = 0.01;
  const Mesh *mesh = shape(k), *theirs = expected_[other] ? &*expected_[other] : shape(other);
  if (has(other, DefectKind::doubled)) theirs = shape(other);
  if (mesh == nullptr) return;
  const StructureInMap& own = result_.subject.structures[k];
  const auto [layer, of_layer] = layer_of(map_, own.segment.layer, frame_);
  Box reach = bounds_of(mesh->points);
  reach.extend(bounds_of(expected_[k]->points));
  const Neighbourhood there = around_now(k, reach, 3);
  // A fit to what is left may end there, where the expected form goes on.
  const Body fit(voxelise(*mesh, there.grid), there.grid), expected(voxelise(*expected_[k], there.grid), there.grid);
  const std::optional<Body> rest =
      theirs != nullptr ? std::optional<Body>(std::in_place, voxelise(*theirs, there.grid), there.grid) : std::nullopt;
  const int label = label_around(result_.subject, k, other);
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
    if (back[v] != 0)
      changes.push_back({there.voxel_of_map(v, layer->geometry), std::max(0, label), own.segment.value});
  take_from_layer(k, other, back, there.grid);
  change(k, changes);
}

}  // namespace

void mend_structures(const SetOfTemplates& set, VolumeRead& map, int frame, const MapRepairOptions& options,
                     RepairedMap& result) {
  Mending(set, map, frame, options, result).find();
}

}  // namespace homolog
