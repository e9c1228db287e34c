#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/numbers/geometry.h"
#include "core/base/result.h"
#include "core/volume/dicom/dicom_clocks.h"
#include "core/volume/dicom/dicom_set.h"
#include "core/volume/stored_voxels.h"

namespace homolog {

/// One plane of a DICOM file; an ordinary file has one.
struct DicomPlane {
  std::optional<Vec3> position_mm;                    ///< LPS, centre of the first voxel
  std::optional<std::pair<Vec3, Vec3>> axes;          ///< unit directions of increasing column and row index
  std::optional<std::pair<double, double>> pixel_mm;  ///< distance between columns, between rows
  std::optional<double> slice_step_mm;                ///< distance between planes, or their thickness
  Rescale rescale;
  std::optional<std::pair<double, double>> window;  ///< centre, width
  DicomTimes times;
  std::optional<double> echo_ms, b_value;  ///< an MR image's values; planes that differ in them are of different images
};

/// Another difference between images of one place: "image types", and the value as it stands in the file.
struct DicomSetting {
  const char* name;
  std::string value;
  bool operator==(const DicomSetting& other) const { return value == other.value; }
};

/// The part of a DICOM file besides its pixels that a volume needs.
struct DicomHeader {
  std::filesystem::path path;
  std::string study_uid, series_uid, series_description, modality;
  std::string instance_uid;        ///< the file's UID; copies have the same
  std::string frame_of_reference;  ///< UID of the space in which positions are given
  double instance_number = 0;
  std::string acquisition_number;
  std::vector<DicomSetting> settings;  ///< the same ones, in the same order, for every file
  int rows = 0, columns = 0, samples_per_pixel = 1;
  int bits_allocated = 0, bits_stored = 0, high_bit = 0;
  bool is_signed = false;
  std::string photometric;
  std::string transfer_syntax;
  bool big_endian = false;
  std::optional<DicomPixels> pixels;
  bool pixels_missing = false;  ///< the file claims more planes than its pixels can be; `planes` is then only the first
  double frame_ms = 0;          ///< time between the planes of a cine; 0 where they are not a cine
  bool planes_are_frames = false;  ///< the file's planes follow one another in time, not in space
  bool has_modality_table = false;
  /// Whether its pixels were compressed with loss at some time ("01"), how much, and how.
  std::string lossy, lossy_ratio, lossy_method;
  std::string steps_through;  ///< its planes step through this besides slices, as "time slots"; empty: through nothing
  std::vector<DicomPlane> planes;
  std::vector<std::string> warnings;

  bool is_image() const { return rows > 0 && columns > 0 && pixels; }
};

/// Collects what is needed from a file's structure; every field may be missing in it.
DicomHeader dicom_header(const DicomSet& set);

}  // namespace homolog
