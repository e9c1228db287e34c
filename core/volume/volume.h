#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/base/numbers/geometry.h"

namespace homolog {

/// The place of a grid of voxels in the patient: p_mm (LPS) = origin + direction · diag(spacing) · voxel index.
/// Integer indices are voxel centres. `direction`'s columns are the unit directions of the i, j and k axes; it may be a
/// reflection (a left-handed grid), never singular.
struct VolumeGeometry {
  std::array<int, 3> dims{0, 0, 0};
  Vec3 spacing_mm = Vec3::Ones();
  Vec3 origin_mm = Vec3::Zero();
  Mat3 direction = Mat3::Identity();

  std::size_t voxels() const {
    return static_cast<std::size_t>(dims[0]) * static_cast<std::size_t>(dims[1]) * static_cast<std::size_t>(dims[2]);
  }
  /// The position of a voxel of the grid among all, i fastest.
  template <std::integral Index>
  std::size_t index(Index i, Index j, Index k) const {
    const auto row = static_cast<std::size_t>(k) * static_cast<std::size_t>(dims[1]) + static_cast<std::size_t>(j);
    return row * static_cast<std::size_t>(dims[0]) + static_cast<std::size_t>(i);
  }
  Vec3 to_mm(const Vec3& voxel) const { return origin_mm + direction * spacing_mm.cwiseProduct(voxel); }
  Vec3 to_voxel(const Vec3& p_mm) const { return (direction.inverse() * (p_mm - origin_mm)).cwiseQuotient(spacing_mm); }
  /// Whether a place lies in a voxel, up to the outer faces of the outermost ones.
  bool holds(const Vec3& p_mm) const;
  /// Box in mm around all voxels (outer faces, not centres).
  Box bounds_mm() const;
  double voxel_volume_mm3() const { return spacing_mm.prod() * std::abs(direction.determinant()); }
  bool operator==(const VolumeGeometry&) const = default;
};

/// True where two grids have the same size and lie at the same place within a hundredth of a voxel.
bool same_grid(const VolumeGeometry& a, const VolumeGeometry& b);

/// 16 hex digits over dims, spacing, origin and direction (rounded to 1e-4): what a case file keeps to recognise its
/// volume.
std::string geometry_hash(const VolumeGeometry& geometry);

/// The voxel types kept in memory; readers convert every other type to the smallest of these that holds its range.
using VoxelData =
    std::variant<std::vector<std::uint8_t>, std::vector<std::int16_t>, std::vector<std::uint16_t>, std::vector<float>>;

/// "uint8", "int16", "uint16" or "float32".
const char* voxel_type_name(const VoxelData& data);

/// A DICOM image that a volume was read from.
struct SourceImage {
  std::string uid;
  std::optional<Vec3> position_mm{};  ///< of its first voxel as the file says it, LPS mm; none of several planes
  int slice = 0;                      ///< of the volume: where that plane lies
  int frame = 0;                      ///< of a file of several planes: which, from 1; else 0
};

/// A scan, a label map, or a cine (several frames on one grid). Voxels are stored i fastest, then j, k, frame.
struct Volume {
  VolumeGeometry geometry;
  int frames = 1;
  double frame_seconds = 0;  ///< time between frames; 0 where the file does not say
  VoxelData data;

  double range_min = 0, range_max = 0;  ///< over all finite voxels of all frames
  /// The window that the file itself asks for (DICOM): centre and width in intensity units.
  std::optional<std::pair<double, double>> file_window;
  bool resampled = false;           ///< its slices were no even stack [VolumeReadOptions::resample]
  std::string series_uid;           ///< DICOM series instance UID; empty elsewhere
  std::string study_uid;            ///< DICOM study instance UID; empty elsewhere
  std::string modality;             ///< "CT", "MR", …; empty where unknown
  std::string frame_of_reference;   ///< UID of the space that positions are given in (DICOM); empty elsewhere
  std::vector<SourceImage> images;  ///< DICOM: what it was read from, those that have a UID; empty elsewhere
  /// A mask of one structure, label 1, whose surface lies where values between voxels pass 0.5 [soft_mask.h].
  bool soft = false;
  /// Slices before the first and behind the last were left out, or may have been, since they are empty (DICOM
  /// segmentations): an organ on the first or last slice ends there and is not cut off.
  bool empty_beyond_slices = false;

  /// Value of a voxel; the index must be inside.
  double at(int i, int j, int k, int frame = 0) const;
  /// Trilinear value at a point in mm; `outside` beyond the outermost voxel centres by more than half a voxel.
  double sample(const Vec3& p_mm, double outside, int frame = 0) const;
};

/// Window (low, high) for display, never empty: the file's own; else soft tissue (−160 … 240) where the values look
/// like Hounsfield units; else from the 0.1 % tail up to where 98 % of what is brighter than the background ends. Large
/// volumes are judged by a sample of their voxels.
std::pair<double, double> default_window(const Volume& volume);

/// The label that a voxel's value stands for: the nearest; 0 where the value is no number, or none that a label can be.
inline int rounded_label(double value) {
  constexpr double beyond = 2147483648.0;
  const double rounded = std::rint(value);
  return std::abs(rounded) < beyond ? static_cast<int>(rounded) : 0;
}

/// Label values other than 0 that occur in a label map's frame, with the number of voxels of each; floats are rounded
/// to the nearest label. A volume with more than 65,535 distinct values returns the first 65,535.
std::map<int, std::size_t> labels_of(const Volume& label_map, int frame = 0);

/// Gives the voxels of any of `labels` the first of them, in all frames, so that it stands for their union. All must
/// occur in the label map; does nothing where there are none.
void unite_labels(Volume& label_map, std::span<const int> labels);

}  // namespace homolog
