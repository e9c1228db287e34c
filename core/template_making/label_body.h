#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/mesh/topology.h"
#include "core/template_making/level_set.h"
#include "core/template_making/voxel_components.h"
#include "core/volume/volume.h"

namespace homolog {

/// The outer face of a label map's first or last plane of voxels in an axis: outward · p = offset_mm.
struct MapSide {
  Vec3 outward;
  double offset_mm = 0;
  Eigen::Index axis = 0;
};

/// A label cut out of a label map with a margin around it: its largest part, cavities filled.
struct LabelBody {
  VolumeGeometry grid;               ///< may reach beyond the label map's
  std::vector<std::uint8_t> inside;  ///< 1 or 0 a voxel of `grid`
  std::vector<float> shares;         ///< a soft mask's values, the surface at 0.5; empty of others
  OneBody body;                      ///< counted in voxels of `grid`
  std::array<bool, 6> touches{};     ///< the label map's first and last plane of i, j and k: that part is cut off there
                                     ///< (but see Volume::empty_beyond_slices)
};

/// The sides of a label map at which a body is cut off.
std::vector<MapSide> sides_that_cut(const LabelBody& body, const VolumeGeometry& map);

/// An estimate of the surface area of a label in mm², from the faces between its voxels and others, and its box in
/// voxels; area 0 where the label does not occur.
struct LabelExtent {
  std::array<int, 3> first{}, last{};
  double area_mm2 = 0;
  std::size_t voxels = 0;
};
LabelExtent label_extent(const Volume& mask, int label, int frame);

/// The size of an organ: the root of its surface area. Lengths that act on shapes are shares of it, so that a skull of
/// 20 mm and a femur of 480 mm are worked on alike. A kidney's is about 160 mm.
double organ_size_mm(const LabelExtent& extent);

/// The same of every label of a frame, and under every_label of all together.
std::map<int, double> label_sizes_mm(const Volume& mask, int frame);

/// Radius of the balls that close and open a label where nobody says another, as a share of the size: about a mm for a
/// kidney.
inline constexpr double ball_share = 0.00625;

/// The voxel size in mm to work on for vertices `edge_mm` apart: a third of that, not below half a voxel, and so large
/// that the label's box with `margin_mm` around it holds 16 million at most.
double worked_spacing_mm(const Volume& mask, const LabelExtent& extent, double edge_mm, double margin_mm);

/// `extent`: the label's own. `margin_mm`: left free on every side, at least two voxels. If an axis has voxels smaller
/// than half of `spacing_mm`, whole blocks of them are made one (inside where at least half are; of a soft mask
/// where their mean is above 0.5), larger ones where the grid would hold more than 16 million. Errors: the label does
/// not occur.
Result<LabelBody> label_body(const Volume& mask, int label, int frame, const LabelExtent& extent, double spacing_mm,
                             double margin_mm);

/// The same with every part of the label, and its cavities: nothing is counted in `body`.
Result<LabelBody> whole_label(const Volume& mask, int label, int frame, const LabelExtent& extent, double spacing_mm,
                              double margin_mm);

/// How many voxels of a region lie outside of a mesh and farther from it than two voxels (of the region's grid, along
/// its longest axis).
std::size_t voxels_off(const LabelBody& region, const Mesh& mesh);

/// The boundary of a region's voxels, or of a soft mask its surface, LPS mm. Errors: nothing is inside.
Result<Mesh> boundary_of(const LabelBody& region);

/// The signed distance to the boundary of a region's voxels. For a soft mask it is that to its surface between the
/// voxels.
LevelSet signed_distance(const LabelBody& region);

/// Nobody can tell a shape of fewer: two in each direction.
inline constexpr std::size_t fewest_voxels_of_shape = 8;

/// Parts of a label, where one was taken.
struct PartsLeftOut {
  std::size_t count = 0;  ///< without the one that was taken
  double share = 0;       ///< their share of the label's voxels
  std::size_t alike = 1;  ///< the largest of all parts, and those more than half as large

  /// Says that they are left out, how many and how much; none where it is less than a hundredth of the label. `taken`:
  /// which part was, as "the largest"; `command`: of which `--parts all` keeps them, with a space behind it; may be
  /// empty.
  std::optional<std::string> warning(int label, const std::string& taken, const std::string& command) const;
};

/// The warning that all parts of the label but the largest are left out; none where they are hardly any of it.
std::optional<std::string> several_parts(const LabelBody& region, int label);

}  // namespace homolog
