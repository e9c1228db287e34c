#pragma once

#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/volume/dicom/dicom_header.h"
#include "core/volume/dicom/dicom_lattice.h"
#include "core/volume/labels/segmentation.h"

namespace homolog {

/// The segments and frames of a DICOM segmentation, known before its pixels are read.
struct SegmentFrames {
  enum class Kind { binary, fractional, label_map };
  Kind kind = Kind::binary;
  double full = 255;              ///< the stored value that stands for 1 in fractional frames
  int background = 0;             ///< a label map's value of what is in no segment
  std::vector<Segment> segments;  ///< as described, by number, in `value`
  std::vector<int> numbers;       ///< the segment of each frame; of a label map 0
  PlacedFrames placed;
  bool begin_bytes = false;             ///< each frame of single bits begins with a byte of its own, against DICOM
  std::vector<std::string> warnings{};  ///< names that cannot be read, and `begin_bytes`
};

/// Reads it. Errors: those of read_dicom_segmentation that are not about pixels.
Result<SegmentFrames> segment_frames(const DicomSet& set, const DicomHeader& header);

}  // namespace homolog
