#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/base/encoding/hash.h"
#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/volume/labels/map_on_grid.h"
#include "core/volume/volume_io.h"

namespace homolog {

/// The voxels of one segment, as it will be written.
struct WrittenSegment {
  Segment segment;  ///< its value and layer in the map
  int number = 0;   ///< its number in the file
};

/// All that goes into the frames of a DICOM segmentation: pixels, and which segment and slice each is of.
struct WrittenFrames {
  int full = 0;                         ///< the value that stands for 1 in fractional frames; 0: single bits
  double rounded = 0;                   ///< the most by which a share was changed
  std::string pixels;                   ///< bits behind one another, or bytes
  std::vector<std::pair<int, int>> of;  ///< segment's number, slice
  Hash hash;
};

/// Whether layers of a map are soft masks [soft_mask.h], so that it is written as fractional segments.
bool is_fractional(const VolumeRead& map);

/// The labels of a map as segments, in their order, numbered from 1; of soft masks one a layer. Errors: soft masks
/// together with a layer of several labels.
Result<std::vector<WrittenSegment>> segments_to_write(const VolumeRead& map);

/// Their frames on the grid of the series; slices without voxels have none. Shares are kept as they are where a value
/// up to 255 can stand for 1 so that all are whole, else in 255ths.
WrittenFrames frames_to_write(const VolumeRead& map, const std::vector<WrittenSegment>& segments,
                              const VolumeGeometry& grid, const VoxelMapping& mapping, Progress* progress);

}  // namespace homolog
