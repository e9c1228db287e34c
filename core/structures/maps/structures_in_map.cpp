#include "core/structures/maps/structures_in_map.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "core/base/text/listed.h"
#include "core/catalogue/catalogue.h"
#include "core/structures/built_in_set.h"
#include "core/structures/naming/level_names.h"
#include "core/structures/repair/voxel_body.h"
#include "core/volume/labels/label_boxes.h"

namespace homolog {

namespace {

/// Around a label, so that a fit sees that it ends there.
constexpr int margin_voxels = 3;

/// The likeness of the likest name: what is less alike is another structure's.
NameLikeness likest_name(const std::vector<Segment>& segments, const std::string& name) {
  NameLikeness most = NameLikeness::none;
  for (const Segment& segment : segments) most = std::max(most, name_likeness(segment.name, name));
  return most;
}

bool is_likely(const std::string& a, const std::string& b) {
  return name_likeness(a, b) != NameLikeness::none;
}

/// Whether a label is a structure of the set by its level alone: no label has the structure's name, and no structure
/// the label's.
bool is_by_level(const Segment& segment, const std::string& structure, const std::vector<Segment>& segments,
                 const TemplateSet& set) {
  return is_same_vertebra(segment.name, structure) && likest_name(segments, structure) == NameLikeness::none &&
         std::ranges::none_of(set.structures,
                              [&](const TemplateOfSet& one) { return is_likely(segment.name, one.name); });
}

int first_free_value(const std::set<int>& used) {
  int value = 1;
  while (used.contains(value)) ++value;
  return value;
}

/// The share of a structure's voxels that another one has too.
double share_held_by(const StructureInMap& one, const StructureInMap& other) {
  const Volume &mask = *one.mask, &theirs = *other.mask;
  const VoxelGrid held(theirs);
  const auto& dims = mask.geometry.dims;
  std::size_t voxels = 0, both = 0;
  std::visit(
      [&](const auto& labels) {
        std::size_t v = 0;
        for (int k = 0; k < dims[2]; ++k)
          for (int j = 0; j < dims[1]; ++j)
            for (int i = 0; i < dims[0]; ++i, ++v) {
              if (rounded_label(labels[v]) != one.segment.value) continue;
              ++voxels;
              both += held.label_at(mask.geometry.to_mm(Vec3(i, j, k))) == other.segment.value ? 1 : 0;
            }
      },
      mask.data);
  return voxels > 0 ? static_cast<double>(both) / static_cast<double>(voxels) : 0;
}

/// Finds structures of two layers that share more than a few voxels.
void find_overlapping(SetInMap& found) {
  constexpr double few = 0.05;  // as where two surfaces touch
  const auto& all = found.structures;
  for (std::size_t a = 0; a < all.size(); ++a)
    for (std::size_t b = a + 1; b < all.size(); ++b) {
      if (!all[a].is_there() || !all[b].is_there() || all[a].segment.layer == all[b].segment.layer) continue;
      if (!all[a].mask->geometry.bounds_mm().intersects(all[b].mask->geometry.bounds_mm())) continue;
      if (share_held_by(all[a], all[b]) <= few && share_held_by(all[b], all[a]) <= few) continue;
      found.overlapping.insert({a, b});
      found.overlapping.insert({b, a});
    }
}

/// The segments of a map by their layers. Those without a name have that of the set's structure that they are.
std::vector<Segmentation> known_by_layer(const std::vector<Segment>& segments, std::size_t layers,
                                         const std::vector<StructureInMap>& structures) {
  std::vector<Segmentation> known(layers);
  for (Segment segment : segments) {
    const auto is_it = [&](const StructureInMap& one) {
      return one.is_there() && one.segment.value == segment.value && one.segment.layer == segment.layer;
    };
    const auto found = std::ranges::find_if(structures, is_it);
    if (found != structures.end() && (segment.name.empty() || is_same_vertebra(segment.name, found->segment.name)))
      segment.name = found->segment.name;
    Segmentation& of_layer = known[segment.layer];
    of_layer.add(std::move(segment));
  }
  return known;
}

/// Leaves out vertices in common that templates do not have, as where one was made anew since.
void drop_shared_beyond(SetOfTemplates& all) {
  const auto vertices_of = [&](const std::string& name) -> Eigen::Index {
    const TemplateOfSet* one = all.set.find(name);
    const std::shared_ptr<const Template> read =
        one == nullptr ? nullptr : all.templates[one - all.set.structures.data()];
    return read == nullptr ? 0 : read->points.rows();
  };
  std::erase_if(all.set.shared, [&](const SharedVertices& shared) {
    const Eigen::Index a = vertices_of(shared.a), b = vertices_of(shared.b);
    if (a == 0 || b == 0) return false;  // it is not fitted
    const bool beyond =
        std::ranges::any_of(shared.vertices, [&](const VertexPair& pair) { return pair[0] >= a || pair[1] >= b; });
    if (beyond)
      all.warnings.push_back(shared.a + " and " + shared.b +
                             ": share vertices that their templates lack; declare them anew with set share");
    return beyond;
  });
}

}  // namespace

Result<SetOfTemplates> load_set_of_templates(const std::string& source) {
  auto set = load_template_set(source);
  if (!set) return fail(set.error());
  SetOfTemplates all{std::move(*set), {}, {}};
  bool any = false;
  for (const TemplateOfSet& one : all.set.structures) {
    auto read = load_template(one.file.string());
    if (!read) all.warnings.push_back(read.error().sentence());
    any = any || read;
    all.templates.push_back(read ? *read : nullptr);
  }
  drop_shared_beyond(all);
  if (!any) return fail(source, "has no template that can be read; the first reason: " + all.warnings.front());
  return all;
}

std::pair<const Volume*, int> layer_of(const VolumeRead& map, std::size_t layer, int frame) {
  if (map.other_layers.empty() || layer == 0) return {&map.volume, map.other_layers.empty() ? frame : 0};
  return {&map.other_layers[layer - 1], 0};
}

int free_value(const VolumeRead& map, int frame, const SetInMap& subject) {
  std::set<int> used;
  for (std::size_t layer = 0; layer <= map.other_layers.size(); ++layer) {
    const auto [volume, of_layer] = layer_of(map, layer, frame);
    for (const auto& [value, box] : label_boxes(*volume, of_layer)) used.insert(value);
  }
  for (const Segment& segment : map.segmentation.segments) used.insert(segment.value);
  for (const StructureInMap& one : subject.structures) used.insert(one.segment.value);
  return first_free_value(used);
}

std::string value_and_layer(const Segment& segment, bool has_layers) {
  return std::to_string(segment.value) + (has_layers ? " of layer " + std::to_string(segment.layer + 1) : "");
}

SetInMap find_in_map(const TemplateSet& set, const VolumeRead& map, int frame) {
  std::vector<Segment> segments = map.segmentation.segments;
  const std::size_t layers = map.other_layers.size() + 1;
  std::vector<std::map<int, VoxelBox>> boxes(layers);
  for (std::size_t layer = 0; layer < layers; ++layer) {
    const auto [volume, of_layer] = layer_of(map, layer, frame);
    boxes[layer] = label_boxes(*volume, of_layer);
    for (const auto& [value, box] : boxes[layer]) {
      const Segment* known =
          map.other_layers.empty() ? map.segmentation.find(value) : map.segmentation.find(value, layer);
      if (known == nullptr) segments.push_back({.name = {}, .value = value, .layer = layer});
    }
  }
  if (layers == 1)
    for (Segment& segment : segments) segment.layer = 0;  // layers that were united
  SetInMap found;
  found.grid = map.volume.geometry;
  std::set<const Segment*> taken;
  for (const TemplateOfSet& one : set.structures) {
    const NameLikeness enough = std::min(likest_name(segments, one.name), NameLikeness::any_case);
    const auto has_name = [&](const Segment& s) {
      const NameLikeness likeness = name_likeness(s.name, one.name);
      return (likeness != NameLikeness::none && likeness >= enough) || is_by_level(s, one.name, segments, set);
    };
    std::vector<const Segment*> named;  // those that have voxels
    for (const Segment& s : segments)
      if (has_name(s) && boxes[s.layer].contains(s.value)) named.push_back(&s);
    auto it = std::ranges::find_if(
        segments, [&](const Segment& s) { return has_name(s) && (named.empty() || &s == named.front()); });
    // A value alone says something only where the map gives it no other name.
    const bool is_named = it != segments.end();
    if (!is_named)
      it = std::ranges::find_if(
          segments, [&](const Segment& s) { return s.name.empty() && s.value == one.value && !taken.contains(&s); });
    StructureInMap there;
    there.by_value = !is_named && it != segments.end();
    there.segment = it != segments.end() ? *it : Segment{one.name, one.value, 0, one.colour, {}};
    if (it != segments.end()) {
      taken.insert(&*it);
      taken.insert(named.begin(), named.end());
      if (named.size() > 1)
        there.why_left_out = "the labels " + value_and_layer(*named[0], layers > 1) + " and " +
                             value_and_layer(*named[1], layers > 1) +
                             " both have its name; give one of them another name";
      else if (const auto box = boxes[it->layer].find(it->value); box != boxes[it->layer].end()) {
        const auto [volume, of_layer] = layer_of(map, it->layer, frame);
        there.mask = cropped(*volume, box->second, margin_voxels, of_layer);
        if (const SoftSegment* soft = soft_of_label(map.soft, *volume, box->second, it->value, it->layer))
          there.soft = soft_on_grid(*soft, *there.mask);
      }
    }
    there.segment.name = one.name;
    if (!there.segment.colour) there.segment.colour = one.colour;
    found.structures.push_back(std::move(there));
  }
  found.known = known_by_layer(segments, layers, found.structures);
  std::set<int> used;  // every label of the map is that of a segment
  for (const Segment& segment : segments) used.insert(segment.value);
  for (const StructureInMap& one : found.structures) used.insert(one.segment.value);
  for (StructureInMap& one : found.structures) {
    if (one.is_there()) continue;
    const int value = one.segment.value;
    const bool is_taken = std::ranges::any_of(segments, [&](const Segment& other) {
      return other.value == value && !is_likely(other.name, one.segment.name) &&
             !is_by_level(other, one.segment.name, segments, set);
    });
    if (!is_taken) continue;
    one.segment.value = first_free_value(used);
    used.insert(one.segment.value);
  }
  for (const Segment& segment : segments) {
    const auto box = boxes[segment.layer].find(segment.value);
    if (taken.contains(&segment) || box == boxes[segment.layer].end()) continue;
    found.without_template.push_back(segment.name.empty() ? "label " + std::to_string(segment.value) : segment.name);
    found.others.push_back(
        {segment, part_of_grid(layer_of(map, segment.layer, frame).first->geometry, box->second).bounds_mm()});
  }
  find_overlapping(found);
  return found;
}

std::string found_by_values(const TemplateSet& set, const SetInMap& subject) {
  std::vector<std::string> found;
  for (std::size_t k = 0; k < set.structures.size(); ++k) {
    const StructureInMap& one = subject.structures[k];
    const std::string number = std::to_string(one.segment.value);
    if (one.by_value && one.is_there() && set.structures[k].name != "label " + number)
      found.push_back(set.structures[k].name + " (" + number + ")");
  }
  if (found.empty()) return {};
  return "gives no names, so labels were taken by the set's values: " + some_of(found) +
         "; if these are other structures, put their names beside the map";
}

}  // namespace homolog
