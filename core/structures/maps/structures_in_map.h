#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/structures/template_set.h"
#include "core/template/template.h"
#include "core/volume/volume_io.h"

namespace homolog {

/// A set with its templates, in the order of its structures.
struct SetOfTemplates {
  TemplateSet set;
  std::vector<std::shared_ptr<const Template>> templates;  ///< null: it could not be read
  std::vector<std::string> warnings;                       ///< why, each a sentence
};

/// Reads a set, of a file or built in, and all its templates. Errors: those of load_template_set; no template can be
/// read.
Result<SetOfTemplates> load_set_of_templates(const std::string& source);

/// The place of a set's structure in a label map.
struct StructureInMap {
  Segment segment;  ///< by its name, else by its value; of one that the map lacks a value that no other label has
  std::optional<Volume> mask;  ///< the part of the map around it; none: the map has no voxel of it

  std::optional<Volume> soft;  ///< a soft mask's shares of the same voxels, label 1; none: they are labels alone
  bool by_value = false;       ///< the map gives no names, and its label is that of the structure's value in the set
  std::string why_left_out;    ///< why nobody knows which label it is; empty: the map has it, or lacks it

  bool is_there() const { return mask.has_value(); }
};

/// A label of a map, and where it lies.
struct LabelOfMap {
  Segment segment;
  Box box_mm;
};

/// The structures of a set that a label map has.
struct SetInMap {
  VolumeGeometry grid;                        ///< the grid of the map's first layer
  std::vector<StructureInMap> structures;     ///< in the set's order
  std::vector<std::string> without_template;  ///< names of the map's labels that the set lacks
  std::vector<LabelOfMap> others;             ///< the same labels
  /// The labels of each layer as neighbours are named by them: by the map's own names, and the set's where
  /// the map gives none.
  std::vector<Segmentation> known;
  /// Structures of two layers that share voxels, as an organ and its lesion, by their places in the set; both ways.
  std::set<std::pair<std::size_t, std::size_t>> overlapping;

  /// Whether two structures are kept from overlapping: those of one layer, and those that share next to no voxel.
  bool lie_apart(std::size_t a, std::size_t b) const { return !overlapping.contains({a, b}); }
};

/// The volume that holds a layer of a map, and which of its frames is meant: layers have one each.
std::pair<const Volume*, int> layer_of(const VolumeRead& map, std::size_t layer, int frame);

/// The name of a segment where several have one name: "3", "1 of layer 2".
std::string value_and_layer(const Segment& segment, bool has_layers);

/// Finds the structures of a set in a frame of a label map: each by its name where the map gives names, else by its
/// value. A vertebra whose name no label has goes by its level: "L3" is "vertebrae_L3". If two labels that have voxels
/// have one name, in any case, both are left out.
SetInMap find_in_map(const TemplateSet& set, const VolumeRead& map, int frame = 0);

/// The sentence that says which structures were found by their values alone; empty: none. Those whose name is no more
/// than their value ("label 3") are not told.
std::string found_by_values(const TemplateSet& set, const SetInMap& subject);

/// A value above 0 that no label of the map has in any layer, and no structure.
int free_value(const VolumeRead& map, int frame, const SetInMap& subject);

}  // namespace homolog
