#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/volume/labels/segmentation.h"
#include "core/volume/labels/soft_mask.h"
#include "core/volume/volume.h"

namespace homolog {

/// One DICOM series found in a folder.
struct SeriesInfo {
  std::string uid;
  std::string description;
  std::string modality;
  int files = 0;
};

/// One of the slices that a series had, as the rectangular grid sees it that they became.
struct OldSlice {
  double height = 0;           ///< its height along the normal, in slices of the grid from the first
  double column = 0, row = 0;  ///< the place of its first voxel, in pixels of the grid
};

/// How slices that are no even stack became a rectangular grid.
struct ResampledSlices {
  std::string why;                   ///< why they were no even stack: "slices that are shifted sideways …"
  int from_slices = 0;               ///< how many slices the series has
  double least_mm = 0, most_mm = 0;  ///< distances between two of them along their normal
  double shifted_mm = 0;             ///< how far they lie sideways against one another
  int columns = 0, rows = 0;         ///< the size of a slice that the series has
  std::array<int, 3> dims{0, 0, 0};  ///< the new grid's size
  Vec3 spacing_mm = Vec3::Zero();    ///< the new grid's voxel spacing
  std::vector<OldSlice> slices{};    ///< the slices of the first frame, by height
};

/// The grid of an image, and of DICOM the space that it lies in and the images that are its slices (empty elsewhere).
struct ImageGrid {
  VolumeGeometry geometry;
  std::string frame_of_reference;
  std::vector<SourceImage> images{};
  std::optional<ResampledSlices> resampled{};  ///< none: the images are slices of the grid
};

/// UIDs of the DICOM images that a segmentation or contours were made on, as far as the file names them, and of the
/// study that it is of itself.
struct ReferencedImages {
  std::vector<std::string> series, instances;
  std::string study;
};

struct VolumeReadOptions {
  std::string series_uid;  ///< which series of a folder that holds several
  /// DICOM: of a folder that holds several series that of these images, where `series_uid` names none.
  ReferencedImages of_images{};
  bool names_no_series = false;          ///< whoever reads has no way to give `series_uid`: errors offer none
  std::optional<Vec3> stack_spacing_mm;  ///< required for a folder (or one file) of PNG/TIFF slices
  Progress* progress = nullptr;          ///< reported to and asked for cancellation when given
  /// NIfTI, NRRD and MetaImage: grid and frames are enough, as their headers say them; `data` stays empty.
  bool without_voxels = false;
  /// Whoever reads takes all layers of a segmentation: nothing is said of which one others take.
  bool all_layers = false;
  /// DICOM: slices that are shifted sideways (a tilted gantry) or unevenly spaced are resampled to a rectangular grid
  /// [resample_slices.h] and not refused.
  bool resample = false;
  /// DICOM segmentations: the image beside which it is read; taken as its grid where its frames lie on slices of that,
  /// in the same space.
  std::optional<ImageGrid> image{};
};

/// A volume and what had to be mended to read it (each a sentence for `homolog: warning: …`).
struct VolumeRead {
  Volume volume;
  std::vector<std::string> warnings;
  Segmentation segmentation;  ///< names and colours of labels, where the file gives some; of layers all labels
  /// The segments are those of the file, so that one without voxels is an empty structure and not only a name: of a
  /// folder of masks, 3D Slicer, DICOM.
  bool segments_are_own = false;
  /// The layers behind `volume`, which is the first, of a segmentation whose segments overlap or share labels (3D
  /// Slicer). Each lies on the same grid, except those of a folder of masks. read_labels.h chooses among them.
  std::vector<Volume> other_layers;
  std::vector<SoftSegment> soft{};  ///< the soft ones of a folder of masks; their labels are rounded
  std::string about_layers{};       ///< while a format reads: that there are layers, for who takes one; then a warning
  ReferencedImages referenced{};    ///< a DICOM segmentation's images
  std::optional<ResampledSlices> resampled{};  ///< none: `VolumeReadOptions::resample` had nothing to do

  /// The layers: `volume` is number 0, the others follow. References are valid as long as this.
  std::size_t layer_count() const { return other_layers.size() + 1; }
  const Volume& layer(std::size_t number) const { return number == 0 ? volume : other_layers[number - 1]; }
  Volume& layer(std::size_t number) { return number == 0 ? volume : other_layers[number - 1]; }
  std::vector<const Volume*> layers() const {
    std::vector<const Volume*> all;
    for (std::size_t number = 0; number < layer_count(); ++number) all.push_back(&layer(number));
    return all;
  }
};

/// Reads a volume of one of the formats in formats/, frames of a cine included: a file, a DICOM series' folder, or a
/// folder of pictures in the order of their names. Geometry is LPS mm; stored values are rescaled to
/// intensities. Errors: absent, truncated, not an image of these kinds, several series and none chosen, a missing slice
/// or uneven ones, vector or 5-D data, sheared axes, more voxels than memory holds, cancelled (within a fraction of a
/// second). Never returns a volume with voxels missing.
Result<VolumeRead> read_volume(const std::filesystem::path& path, const VolumeReadOptions& options = {});

/// The series of images in a DICOM folder, by UID; empty where there is none.
Result<std::vector<SeriesInfo>> list_series(const std::filesystem::path& folder);

/// Whether the name (or, for a folder, the content) is that of a volume that read_volume takes.
bool looks_like_volume(const std::filesystem::path& path);

/// Whether a path holds PNG or TIFF slices: reading them needs stack_spacing_mm.
bool is_picture_stack(const std::filesystem::path& path);

/// Writes NIfTI (.nii, .nii.gz; qform and sform, RAS on disk), NRRD (.nrrd) or MetaImage (.mha), chosen by the
/// extension, whole or not at all. NIfTI-1 keeps the place in single precision; where that would move voxels by more
/// than a thousandth of one, or an axis has more than 32,767 voxels, NIfTI-2 is written. Errors: the extension, the
/// disk, cancelled, those of check_volume. `record`: how the image was made [file_record.h], in NRRD, or beside the
/// file; one that lies there and is of no more use is removed.
Result<void> write_volume(const Volume& volume, const std::filesystem::path& path, Progress* progress = nullptr,
                          const std::string& record = {});

}  // namespace homolog
