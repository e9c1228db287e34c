#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/result.h"
#include "core/volume/volume_io.h"

namespace homolog {

/// Frames of one size on parallel planes, as a file places them; LPS mm.
struct PlacedFrames {
  int columns = 0, rows = 0;
  std::pair<Vec3, Vec3> axes;          ///< unit directions of increasing column and row index
  std::pair<double, double> pixel_mm;  ///< distance between columns, between rows
  std::vector<Vec3> positions_mm;      ///< of each frame, the centre of its first voxel
  std::vector<std::string> images{};   ///< of each frame: the only image it was made of [named_image]; empty: not said
  /// Distance between slices and their thickness, as far as the file gives them.
  std::optional<double> spacing_mm, thickness_mm;
};

/// A grid on whose slices all frames lie, and the slice of each.
struct FrameLattice {
  VolumeGeometry geometry;
  std::vector<int> slices;
  bool by_images = false;   ///< frames were put where the images are that they refer to
  bool old_slices = false;  ///< the grid is of the slices that a series had before it was resampled, in their pixels
};

/// The slices of frames of which the empty ones may have been left out, so that gaps stay gaps. Their distance is the
/// one that the file gives, where all gaps are multiples of it. Else of frames that mostly follow one another it is the
/// smallest gap, of others their thickness, else the largest step of which all gaps are multiples. `warnings`: a
/// distance that was found or assumed against what the file says. Errors: frames shifted to the side, or places that
/// are on no even lattice, or on one of smaller steps alone where most frames lie apart as the file says.
Result<FrameLattice> lattice_of(const std::filesystem::path& path, const PlacedFrames& frames,
                                std::vector<std::string>& warnings);

/// How far voxels may lie from those of a grid to be taken for them, in voxels: a hundredth, and up to a quarter where
/// 0.2 mm are as much. By that the places of slices that are taken for even may be rounded or uneven.
Vec3 near_voxels(const Vec3& spacing_mm);

/// The slices on a known grid, such as that of the series that was segmented; nothing where the frames do not lie on
/// it [near_voxels], or where two of different places lie on one slice.
std::optional<FrameLattice> on_grid(const PlacedFrames& frames, const VolumeGeometry& grid);

/// The slices of the images that frames refer to, whether or not these lie evenly; nothing where a frame refers to none
/// of them, or lies beside its image [near_voxels].
std::optional<FrameLattice> on_images(const PlacedFrames& frames, const ImageGrid& series);

/// The slices that a series had before it was resampled [ImageGrid::resampled], on which frames lie; nothing where one
/// lies on none of them [near_voxels]. The grid has these slices as if they lay evenly [take_slices].
std::optional<FrameLattice> on_old_slices(const PlacedFrames& frames, const ImageGrid& series);

/// The slices on the grid of a series: on those of the images that frames refer to, else on the grid. Of a series that
/// was resampled on those that it had, where frames refer to images or lie on no slices of the grid. Nothing where they
/// lie on none of these.
std::optional<FrameLattice> lattice_on_series(const PlacedFrames& frames, const ImageGrid& series);

/// Warnings about frames (of `path`) that were put on slices: that they lie off these by more than rounded
/// places do, and which refers to an image of another slice than the one it lies on.
std::vector<std::string> doubts_about_places(const std::filesystem::path& path, const PlacedFrames& frames,
                                             const FrameLattice& lattice, const std::vector<SourceImage>& images);

}  // namespace homolog
