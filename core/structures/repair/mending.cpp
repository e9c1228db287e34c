#include "core/structures/repair/mending.h"

#include <cmath>

#include "core/adapt/labels/choose_closing.h"
#include "core/adapt/snap.h"
#include "core/base/numbers/index.h"
#include "core/base/processes/parallel.h"
#include "core/mesh/mesh_quality.h"
#include "core/mesh/voxels/voxelise.h"
#include "core/placement/similarity_fit.h"

// How voxels of a map are changed.

namespace homolog {

namespace {

constexpr double near_share = 0.1;  ///< share of a structure's size: so far from its shape voxels are given back

}  // namespace

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
  return {&map_.layer(layer), 0};
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

void Mending::find_shapes() {
  std::vector<std::size_t> asked;
  for (std::size_t k = 0; k < result_.structures.size(); ++k)
    if (is_asked(k)) asked.push_back(k);
  for_each_in_parallel(asked.size(), [&](std::size_t a) { shape(asked[a]); });
}

Mesh Mending::as_the_image_shows(std::size_t k, const Mesh& expected) const {
  constexpr double near_by_size = 0.2, hardly_seen = 0.2;
  if (options_.image == nullptr) return expected;
  const Eigen::Index count = expected.points.rows();
  SnapStart start{.mesh = expected,
                  .placed = expected.points,
                  .stiffness = set_.templates[k]->stiffness,
                  .free = VertexScalars::Ones(count)};
  Progress own(silent_, 0);
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
  if (!expected_[k] || !there.is_there() || silent_.cancelled()) return expected_[k] ? &*expected_[k] : nullptr;
  const Template& own = *set_.templates[k];
  const int value = there.segment.value;
  const auto boundary =
      label_boundary(*there.mask, value, 0, usual_closing_mm(*there.mask, value, 0), own.points.rows(), {.all = true});
  shapes_[k] = expected_[k];
  if (!boundary) return &*shapes_[k];
  Progress progress(silent_, 0);
  FitOptions options;
  options.progress = &progress;
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

std::optional<Mending::Lack> Mending::lack_of(std::size_t k) {
  constexpr double least_share = 0.01;
  const Mesh* mesh = shape(k);
  if (mesh == nullptr) return std::nullopt;
  Neighbourhood there = around_now(k, bounds_of(mesh->points), 3);
  std::vector<std::uint8_t> inside = voxelise(*mesh, there.grid);
  const Body own(voxels_with(there.labels, result_.subject.structures[k].segment.value), there.grid);
  // What is missing is thick; a layer of a voxel around what is there is only how the mesh lies.
  const double thick_mm = 1.5 * there.grid.spacing_mm.maxCoeff();
  std::vector<std::uint8_t> core(inside.size());
  std::size_t all = 0;
  for (std::size_t v = 0; v < inside.size(); ++v) {
    all += inside[v];
    core[v] = inside[v] != 0 && there.labels[v] == 0 && own.to[v] > thick_mm ? 1 : 0;
  }
  core = large_parts(std::move(core), there.grid, least_share * static_cast<double>(own.voxels));
  const Body missing(std::move(core), there.grid);
  Lack lack{
      std::move(there), {}, static_cast<double>(missing.voxels) / static_cast<double>(std::max<std::size_t>(1, all))};
  lack.voxels.resize(inside.size());
  for (std::size_t v = 0; v < inside.size(); ++v)
    lack.voxels[v] = inside[v] != 0 && missing.to[v] <= 1.5 * thick_mm ? 1 : 0;
  return lack;
}

std::vector<std::size_t> Mending::takers_of_bent(std::size_t k) {
  constexpr double some = 0.02, mostly = 0.7;  // shares of its voxels, and of the other's own: so much is clear
  constexpr std::size_t few = 12;              // voxels, which tell nothing
  std::vector<std::size_t> takers;
  const Mesh* mesh = shape(k);
  if (mesh == nullptr) return takers;
  const Neighbourhood there = around_now(k, bounds_of(mesh->points), 3);
  const std::vector<std::uint8_t> bent = voxelise(*mesh, there.grid);
  const auto least = std::max(few + 1.0, some * static_cast<double>(std::ranges::count(bent, std::uint8_t{1})));
  for (std::size_t n = 0; n < expected_.size(); ++n) {
    if (n == k || !expected_[n] || !result_.subject.structures[n].is_there()) continue;
    const int label = label_around(result_.subject, k, n);
    std::vector<std::size_t> held;
    for (std::size_t v = 0; v < bent.size(); ++v)
      if (bent[v] != 0 && there.labels[v] == label) held.push_back(v);
    if (static_cast<double>(held.size()) < least) continue;
    // What lies within the shape that is expected of the other one is its own: a gallbladder lies in the liver.
    const std::vector<std::uint8_t> theirs = voxelise(*expected_[n], there.grid);
    const auto is_lost = [&](std::size_t v) { return theirs[v] == 0; };
    const auto lost = static_cast<double>(std::ranges::count_if(held, is_lost));
    if (lost >= std::max(least, mostly * static_cast<double>(held.size()))) takers.push_back(n);
  }
  return takers;
}

void Mending::give(std::size_t k, std::size_t other, const BodyInMap& body) {
  const Segment &own = result_.subject.structures[k].segment, &theirs = result_.subject.structures[other].segment;
  const auto [layer, of_layer] = layer_of(map_, theirs.layer, frame_);
  const bool same_layer = own.layer == theirs.layer;
  if (!same_layer && !same_grid(layer->geometry, voxels_of(k).first->geometry)) return;
  std::vector<VoxelChange> from, to;
  for (std::size_t v = 0; v < body.inside.size(); ++v) {
    if (body.inside[v] == 0) continue;
    const std::size_t voxel = body.there.voxel_of_map(v, layer->geometry);
    from.push_back({voxel, theirs.value, same_layer ? own.value : 0});
    if (!same_layer) to.push_back({voxel, 0, own.value});
  }
  change(same_layer ? k : other, from);
  change(k, to);
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

}  // namespace homolog
