#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/result.h"
#include "core/template/voxel_components.h"
#include "core/volume/volume.h"

namespace homolog {

/// A label cut out of a label map with a margin around it: its largest part, cavities filled.
struct LabelRegion {
  VolumeGeometry grid;               ///< may reach beyond the label map's
  std::vector<std::uint8_t> inside;  ///< 1 or 0 a voxel of `grid`
  OneBody body;                      ///< counted in voxels of `grid`
  std::array<bool, 6> touches{};     ///< the label map's first and last plane of i, j and k: the organ is cut off there
};

/// `margin_mm`: left free on every side, at least two voxels. Where an axis has voxels smaller than half of
/// `spacing_mm`, whole blocks of them are made one (inside where at least half are). Errors: the label does not occur.
Result<LabelRegion> label_region(const Volume& mask, int label, int frame, double spacing_mm, double margin_mm);

/// An estimate of the surface area of a label in mm², from the faces between its voxels and others, and its box in
/// voxels; area 0 where the label does not occur.
struct LabelExtent {
  std::array<int, 3> first{}, last{};
  double area_mm2 = 0;
};
LabelExtent label_extent(const Volume& mask, int label, int frame);

}  // namespace homolog
