#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/structures/naming/level_names.h"
#include "core/structures/repair/repair.h"
#include "core/structures/repair/second_body.h"
#include "core/structures/repair/voxel_body.h"

namespace homolog {

/// The work on one map.
class Mending {
 public:
  Mending(const SetOfTemplates& set, VolumeRead& map, int frame, const MapRepairOptions& options, RepairedMap& result)
      : set_(set),
        map_(map),
        frame_(frame),
        options_(options),
        silent_(options.progress != nullptr ? *options.progress : unseen_, 0),
        result_(result),
        expected_(result.expected),
        shapes_(expected_.size()) {}

  void find();

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
  /// Says what is left of a sign where other changes have mended some of its voxels.
  double share_left(std::size_t k, double share, const std::vector<VoxelChange>& changes);
  /// Changes the voxels that still have the label that they had.
  void change(std::size_t k, const std::vector<VoxelChange>& changes);
  void find_in(std::size_t k);
  /// Whether its template is cut off itself and no shape is expected of it: what the fit leaves out may be what the
  /// template lacks.
  bool is_beside_cut(std::size_t k) const;
  /// Whether a structure shows that something was added to it.
  bool has_too_much(std::size_t k) const;
  /// Whether a structure's fit and its expected shape tell what it lost.
  bool is_compared(std::size_t k) const;
  /// Who has a part that a structure lost.
  std::vector<std::size_t> takers_of(std::size_t k) const;
  bool lacks_a_part(std::size_t k) const;
  /// Whether its template, bent to what there is of it, is to tell what it has lost.
  bool is_asked(std::size_t k) const;
  /// Finds what a structure has lost, to a neighbour or to nobody.
  void find_lost(std::size_t k);
  /// The shapes that find_lost asks for, all at once: each is a fit that takes seconds.
  void find_shapes();
  void find_missing(std::size_t k);
  /// Whether the map has structures of its kind at all: where it has no disc, no disc is missing.
  bool is_segmented(std::size_t k) const;
  /// How a structure should be: its template fitted to what there is of it. Null: nobody knows.
  const Mesh* shape(std::size_t k);
  /// A shape that others expect, drawn to the boundary that the image shows; itself where it shows too little.
  Mesh as_the_image_shows(std::size_t k, const Mesh& expected) const;
  /// Gives voxels without a label that of a structure.
  void fill(std::size_t k, const Neighbourhood& there, const std::function<bool(std::size_t)>& is_its);
  /// The part that a structure lacks by its template, bent to what there is of it.
  struct Lack {
    Neighbourhood there;
    std::vector<std::uint8_t> voxels;  ///< voxels to fill, where they have no label
    double share = 0;                  ///< share of the template's voxels, without the outermost ones
  };
  std::optional<Lack> lack_of(std::size_t k);
  /// Who has a part of a structure by its template, bent to what there is of it: a rib may lie beside its expected
  /// shape.
  std::vector<std::size_t> takers_of_bent(std::size_t k);
  /// Gives a structure a body that has another one's label.
  void give(std::size_t k, std::size_t other, const BodyInMap& body);
  /// Gives a structure what another one has of it.
  void take_back(std::size_t k, std::size_t other);

  const SetOfTemplates& set_;
  VolumeRead& map_;
  int frame_;
  const MapRepairOptions& options_;
  Progress unseen_;
  mutable Progress silent_;  ///< can be cancelled, and counts as no time
  RepairedMap& result_;
  const std::vector<std::optional<Mesh>>& expected_;
  std::vector<std::optional<Mesh>> shapes_;
};

}  // namespace homolog
