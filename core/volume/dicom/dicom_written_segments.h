#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/volume/dicom/dicom_elements.h"
#include "core/volume/dicom/dicom_written_frames.h"

namespace homolog {

/// A code of a scheme, and what it means.
DicomElements coded(const std::string& value, const std::string& scheme, const std::string& meaning);

/// The descriptions of segments [DICOM PS3.3, C.8.20.4]: number, label, description, colour, and what they are of. A
/// label has at most 64 characters, no backslash, and no other segment's; where it is not the name as it stands, that
/// is the description. What a segment is of are 3D Slicer's codes [Segment::terminology], else an anatomical structure.
/// `warnings`, about `path`: labels that are not the names; codes that have no place.
std::vector<DicomElements> described_segments(const std::filesystem::path& path,
                                              const std::vector<WrittenSegment>& segments,
                                              std::vector<std::string>& warnings);

}  // namespace homolog
