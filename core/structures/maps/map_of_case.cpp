#include "core/structures/maps/map_of_case.h"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "core/base/numbers/index.h"
#include "core/base/text/text.h"
#include "core/case/actions/history_marks.h"
#include "core/mesh/voxels/voxelise.h"
#include "core/structures/maps/case_segments.h"
#include "core/structures/maps/structures_in_map.h"
#include "core/volume/labels/label_boxes.h"

namespace homolog {

namespace {

constexpr std::size_t per_run = 5;

/// A label of a layer.
using Label = std::pair<std::size_t, int>;

/// A structure of the case at the frame of the fit, and its label.
struct OfCase {
  const Structure& structure;
  const Shape& shape;
  Label label;
  const InFittedMap* in = nullptr;  ///< null: the fit did not find it
  bool is_changed = false;          ///< its voxels are those within its mesh
  bool is_back = false;             ///< a person took back what the repair proposes

  Mesh mesh() const { return {structure.the_template->topology, *shape.points}; }
};

bool is_as_read(const Shape& shape, const InFittedMap& in) {
  constexpr double rounding_mm = 1e-4;
  if (in.as_read.empty() || std::ssize(in.as_read) != shape.points->size()) return false;
  const Eigen::Map<const Points> before(in.as_read.data(), shape.points->rows(), 3);
  return (*shape.points - before).cwiseAbs().maxCoeff() < rounding_mm;
}

/// The frame of the case that a map is written of.
int frame_of(const Document& document, const KeptMapFit& fit) {
  return fit.structures.empty() ? document.frame : fit.frame;
}

bool is_changed_since(const Shape& shape, const InFittedMap& in) {
  return !is_as_read(shape, in) && mesh_hash(*shape.points) != in.mesh;
}

int free_label(const VolumeRead& map, const std::vector<OfCase>& more) {
  std::set<int> taken;
  for (std::size_t layer = 0; layer < map.layer_count(); ++layer)
    for (int frame = 0; frame < map.layer(layer).frames; ++frame)
      for (const auto& [value, voxels] : labels_of(map.layer(layer), frame)) taken.insert(value);
  for (const Segment& segment : map.segmentation.segments) taken.insert(segment.value);
  for (const OfCase& one : more) taken.insert(one.label.second);
  int value = 1;
  while (taken.contains(value)) ++value;
  return value;
}

/// The segment that has a name, in any case.
const Segment* segment_called(const VolumeRead& map, const std::string& name) {
  for (const Segment& segment : map.segmentation.segments)
    if (lower_case(segment.name) == lower_case(name)) return &segment;
  return nullptr;
}

std::vector<OfCase> structures_of(const Document& document, int frame, const VolumeRead& map, const KeptMapFit& fit) {
  std::vector<OfCase> all;
  for (const auto& structure : document.structures) {
    const Shape* shape = structure->shape(frame);
    if (shape == nullptr) continue;
    OfCase one{*structure, *shape, {}};
    if (const auto found = fit.structures.find(structure->id); found != fit.structures.end()) {
      one.in = &found->second;
      one.label = {one.in->layer, one.in->value};
      one.is_back = is_as_read(*shape, *one.in);
      one.is_changed = is_changed_since(*shape, *one.in);
    } else {
      const Segment* segment = segment_called(map, structure_name(*structure));
      if (segment == nullptr) segment = segment_called(map, structure->label);
      const auto layer = std::min(map.layer_count() - 1, static_cast<std::size_t>(structure->layer));
      one.label = segment != nullptr ? Label(segment->layer, segment->value) : Label(layer, free_label(map, all));
      one.is_changed = true;
    }
    all.push_back(one);
  }
  return all;
}

/// Labels that stay as the map was read.
std::set<Label> labels_taken_back(const std::vector<OfCase>& all, const KeptMapFit& fit) {
  std::set<Label> back;
  for (const auto& [id, in] : fit.structures) {
    const auto is_it = [&, &id = id](const OfCase& one) { return one.structure.id == id; };
    const auto found = std::ranges::find_if(all, is_it);
    const bool is_gone = found == all.end() && in.was_missing;
    if (is_gone || (found != all.end() && found->is_back)) back.emplace(in.layer, in.value);
  }
  return back;
}

/// Makes the map that the repair proposes. False where the map is another one.
bool propose(VolumeRead& map, const std::vector<std::uint32_t>& changes, const std::set<Label>& back) {
  if (changes.size() % per_run != 0) return false;
  for (std::size_t at = 0; at < changes.size(); at += per_run) {
    const std::size_t layer = changes[at], first = changes[at + 1], count = changes[at + 2];
    const int from = static_cast<int>(changes[at + 3]), to = static_cast<int>(changes[at + 4]);
    if (layer >= map.layer_count()) return false;
    Volume& volume = map.layer(layer);
    const bool is_it = std::visit(
        [&](auto& voxels) {
          using Voxel = typename std::decay_t<decltype(voxels)>::value_type;
          if (count > voxels.size() || first > voxels.size() - count) return false;
          for (std::size_t v = first; v < first + count; ++v) {
            if (rounded_label(static_cast<double>(voxels[v])) != from) return false;
            if (!back.contains({layer, from}) && !back.contains({layer, to})) voxels[v] = static_cast<Voxel>(to);
          }
          return true;
        },
        volume.data);
    if (!is_it) return false;
    volume.range_max = std::max(volume.range_max, static_cast<double>(to));
  }
  return true;
}

/// Gives one structure the voxels within its mesh. `all`: who holds which label.
void draw_mesh(Volume& volume, std::size_t first_voxel, const OfCase& one, const std::vector<OfCase>& all) {
  const auto [layer, value] = one.label;
  const Mesh mesh = one.mesh();
  const VolumeGeometry& grid = volume.geometry;
  const VoxelBox box = voxels_around(bounds_of(mesh.points), grid, 1);
  const VolumeGeometry part = part_of_grid(grid, box);
  const auto inside = voxelise(mesh, part);
  std::map<int, std::vector<std::uint8_t>> held;  // by the structures of other labels
  const auto is_held = [&, layer = layer](int other, std::size_t at) {
    const auto holds = [&](const OfCase& owner) { return owner.label == Label(layer, other); };
    auto known = held.find(other);
    if (known == held.end()) {
      const auto owner = std::ranges::find_if(all, holds);
      known =
          held.emplace(other, owner == all.end() ? std::vector<std::uint8_t>() : voxelise(owner->mesh(), part)).first;
    }
    return known->second.empty() || known->second[at] != 0;
  };
  std::visit(
      [&, value = value](auto& voxels) {
        using Voxel = typename std::decay_t<decltype(voxels)>::value_type;
        for (std::size_t v = first_voxel; v < first_voxel + grid.voxels(); ++v)
          if (rounded_label(static_cast<double>(voxels[v])) == value) voxels[v] = Voxel{0};
        std::size_t at = 0;
        for (int k = box.first[2]; k <= box.last[2]; ++k)
          for (int j = box.first[1]; j <= box.last[1]; ++j) {
            const std::size_t row = first_voxel + grid.index(box.first[0], j, k);
            for (std::size_t i = 0; i < index(part.dims[0]); ++i, ++at) {
              if (inside[at] == 0) continue;
              const int other = rounded_label(static_cast<double>(voxels[row + i]));
              if (other == 0 || !is_held(other, at)) voxels[row + i] = static_cast<Voxel>(value);
            }
          }
      },
      volume.data);
  volume.range_max = std::max(volume.range_max, static_cast<double>(value));
}

/// The label and name that a structure that was renamed goes to.
Segment renamed(const OfCase& one, const VolumeRead& map, const KeptMapFit& fit, const std::vector<OfCase>& all) {
  Segment segment{.name = structure_name(one.structure), .value = one.label.second, .layer = one.label.first};
  for (const auto& [id, in] : fit.structures) {
    if (lower_case(in.name) != lower_case(segment.name) || in.layer != segment.layer) continue;
    segment.value = in.value;
    if (const Segment* known = map.segmentation.find(in.value, in.layer); known != nullptr && !known->name.empty())
      segment.name = known->name;
    return segment;
  }
  const Segment* known = segment_called(map, segment.name);
  segment.value = known != nullptr && known->layer == segment.layer ? known->value : free_label(map, all);
  return segment;
}

bool is_renamed(const OfCase& one) {
  return one.in != nullptr && lower_case(structure_name(one.structure)) != lower_case(one.in->name);
}

/// Moves labels to the values of their new names. Errors: two labels would become one.
Result<void> rename_in(VolumeRead& map, const KeptMapFit& fit, std::vector<OfCase>& all) {
  std::map<Label, Segment> moved;
  for (OfCase& one : all) {
    if (!is_renamed(one)) continue;
    Segment to = renamed(one, map, fit, all);
    const Label from = one.label;
    one.label = {to.layer, to.value};
    moved.emplace(from, std::move(to));
  }
  if (moved.empty()) return {};
  for (std::size_t layer = 0; layer < map.layer_count(); ++layer) {
    Volume& volume = map.layer(layer);
    std::map<int, int> values;
    std::set<int> reached;
    for (int frame = 0; frame < volume.frames; ++frame)
      for (const auto& [value, voxels] : labels_of(volume, frame)) values.emplace(value, value);
    for (auto& [value, to] : values) {
      if (const auto found = moved.find({layer, value}); found != moved.end()) to = found->second.value;
      if (!reached.insert(to).second) {
        const Segment* clash = map.segmentation.find(to, layer);
        return fail(clash != nullptr && !clash->name.empty() ? clash->name : "label " + std::to_string(to),
                    "would be the name of two labels of the map; rename the structure, or fit the other label too");
      }
    }
    std::visit(
        [&](auto& voxels) {
          using Voxel = typename std::decay_t<decltype(voxels)>::value_type;
          for (Voxel& voxel : voxels)
            if (const auto to = values.find(rounded_label(static_cast<double>(voxel))); to != values.end())
              voxel = static_cast<Voxel>(to->second);
        },
        volume.data);
    if (!values.empty()) volume.range_max = std::max(volume.range_max, static_cast<double>(*reached.rbegin()));
  }
  // What the map says of a value stays with the value; a name without voxels is no loss.
  for (const auto& [from, to] : moved)
    if (map.segmentation.find(to.value, to.layer) == nullptr) map.segmentation.add(to);
  return {};
}

/// Names and colours of the case's structures in the map.
void describe(VolumeRead& map, const std::vector<OfCase>& all) {
  for (const OfCase& one : all) {
    const auto& [layer, value] = one.label;
    auto& segments = map.segmentation.segments;
    const auto is_it = [&, layer = layer, value = value](const Segment& s) {
      return s.layer == layer && s.value == value;
    };
    if (const auto known = std::ranges::find_if(segments, is_it); known != segments.end()) {
      if (known->name.empty()) known->name = structure_name(one.structure);
      if (one.structure.colour) known->colour = one.structure.colour;
      continue;
    }
    Segment segment{.name = structure_name(one.structure), .value = value, .layer = layer};
    segment.colour = one.structure.colour.value_or(colour_by_name(segment.name));
    map.segmentation.add(std::move(segment));
  }
}

/// Whether the map's numbers reach up to every label.
bool holds_values(const VolumeRead& map, const std::vector<OfCase>& all) {
  return std::ranges::all_of(all, [&](const OfCase& one) {
    return std::visit(
        [&](const auto& voxels) {
          using Voxel = typename std::decay_t<decltype(voxels)>::value_type;
          return one.label.second > 0 && one.label.second <= static_cast<double>(std::numeric_limits<Voxel>::max());
        },
        map.layer(one.label.first).data);
  });
}

}  // namespace

std::vector<std::string> drawn_by_mesh(const Document& document, const KeptMapFit& fit) {
  std::vector<std::string> names;
  for (const auto& one : document.structures) {
    const Shape* shape = one->shape(frame_of(document, fit));
    if (shape == nullptr) continue;
    const auto found = fit.structures.find(one->id);
    if (found == fit.structures.end() || is_changed_since(*shape, found->second)) names.push_back(structure_name(*one));
  }
  return names;
}

std::vector<std::uint32_t> voxel_changes(const VolumeRead& before, const VolumeRead& after) {
  std::vector<std::uint32_t> runs;
  const auto add = [&](std::size_t layer, std::size_t voxel, int from, int to) {
    const std::uint32_t last = runs.empty() ? 0 : runs[runs.size() - per_run + 1] + runs[runs.size() - per_run + 2];
    if (!runs.empty() && runs[runs.size() - per_run] == layer && last == voxel &&
        runs[runs.size() - 2] == static_cast<std::uint32_t>(from) &&
        runs[runs.size() - 1] == static_cast<std::uint32_t>(to)) {
      ++runs[runs.size() - per_run + 2];
      return;
    }
    for (const std::size_t number :
         {layer, voxel, std::size_t{1}, static_cast<std::size_t>(from), static_cast<std::size_t>(to)})
      runs.push_back(static_cast<std::uint32_t>(number));
  };
  for (std::size_t layer = 0; layer < before.layer_count(); ++layer) {
    const Volume& now = after.layer(layer);
    std::visit(
        [&]<class Voxel>(const std::vector<Voxel>& voxels) {
          const auto& changed = std::get<std::vector<Voxel>>(now.data);
          for (std::size_t v = 0; v < voxels.size(); ++v)
            if (voxels[v] != changed[v])
              add(layer, v, rounded_label(static_cast<double>(voxels[v])),
                  rounded_label(static_cast<double>(changed[v])));
        },
        before.layer(layer).data);
  }
  return runs;
}

Result<VolumeRead> map_of_case(const Document& document, VolumeRead map, const KeptMapFit& fit, Progress& progress) {
  const int frame = frame_of(document, fit);
  const auto is_beyond = [&](const auto& one) { return one.second.layer >= map.layer_count(); };
  auto all = structures_of(document, frame, map, fit);
  if (std::ranges::any_of(fit.structures, is_beyond) || !propose(map, fit.changes, labels_taken_back(all, fit)))
    return fail("", "is not the label map that was repaired; fit the set to it again");
  if (!holds_values(map, all)) return fail("", "has no room for another label; write it with 16 bits a voxel");
  std::size_t done = 0;
  for (const OfCase& one : all) {
    progress.report(static_cast<double>(done++) / static_cast<double>(all.size()));
    if (progress.cancelled()) return fail("", "was cancelled");
    if (!one.is_changed) continue;
    Volume& volume = map.layer(one.label.first);
    const bool has_frame = map.other_layers.empty() && frame < volume.frames;
    draw_mesh(volume, has_frame ? volume.geometry.voxels() * index(frame) : 0, one, all);
  }
  if (auto named = rename_in(map, fit, all); !named) return fail(named.error());
  if (!holds_values(map, all)) return fail("", "has no room for another label; write it with 16 bits a voxel");
  describe(map, all);
  return map;
}

}  // namespace homolog
