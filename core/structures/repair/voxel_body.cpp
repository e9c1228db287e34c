#include "core/structures/repair/voxel_body.h"

namespace homolog {

namespace {

/// Whether voxels of a structure in another layer are no room for one.
bool bars(const SetInMap& subject, std::size_t of, std::size_t other) {
  const auto overlaps_any = [&] {
    const auto first = subject.overlapping.lower_bound({other, 0});
    return first != subject.overlapping.end() && first->first == other;
  };
  return subject.structures[of].is_there() ? subject.lie_apart(of, other) : !overlaps_any();
}

}  // namespace

int label_around(const SetInMap& subject, std::size_t of, std::size_t other) {
  const Segment &own = subject.structures[of].segment, &theirs = subject.structures[other].segment;
  return own.layer == theirs.layer ? theirs.value : -1 - static_cast<int>(other);
}

Neighbourhood around_structure(const SetInMap& subject, const VolumeRead& map, int frame, std::size_t of,
                               const Box& reach, int margin) {
  const auto [own, of_own] = layer_of(map, subject.structures[of].segment.layer, frame);
  Neighbourhood there = around(reach, *own, of_own, margin);
  const HeldByOthers held(subject, map, frame, of, there.grid.bounds_mm());
  for (std::size_t v = 0; v < there.labels.size() && !held.empty(); ++v)
    if (there.labels[v] == 0) there.labels[v] = held.label_at(place_of_voxel(there.grid, v));
  return there;
}

HeldByOthers::HeldByOthers(const SetInMap& subject, const VolumeRead& map, int frame, std::size_t of,
                           const std::optional<Box>& within) {
  for (std::size_t n = 0; n < subject.structures.size(); ++n) {
    const StructureInMap& other = subject.structures[n];
    const int label = label_around(subject, of, n);
    if (n == of || label >= 0 || !bars(subject, of, n)) continue;
    const auto [layer, of_layer] = layer_of(map, other.segment.layer, frame);
    if (within && other.is_there()) {
      Box near = other.mask->geometry.bounds_mm();  // and what repair may have added
      const Vec3 more = near.sizes() / 2;
      near = Box(near.min() - more, near.max() + more);
      if (!near.intersects(*within)) continue;
    }
    if (!other.is_there() && layer->range_max < other.segment.value) continue;
    all_.push_back({VoxelGrid(*layer, of_layer), other.segment.value, label});
  }
}

int HeldByOthers::label_at(const Vec3& p_mm) const {
  for (const Held& one : all_)
    if (one.layer.label_at(p_mm) == one.value) return one.label;
  return 0;
}

}  // namespace homolog
