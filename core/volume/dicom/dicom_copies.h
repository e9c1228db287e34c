#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/volume/dicom/dicom_header.h"

namespace homolog {

/// The images of a series without copies of one another: files with the same instance UID, place, times and pixels. The
/// first of each is kept, and `warnings` says so. Files that only share their UID, as careless anonymising leaves them,
/// all stay.
std::vector<DicomHeader> without_copies(const std::filesystem::path& path, const std::vector<DicomHeader>& headers,
                                        std::vector<std::string>& warnings);

}  // namespace homolog
