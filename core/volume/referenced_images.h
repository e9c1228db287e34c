#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/volume/dicom/dicom_set.h"
#include "core/volume/volume_io.h"

namespace homolog {

/// The name of the image that an item of a DICOM file refers to: its UID, and of a file of several planes, where the
/// item says which, also the number of that one. Empty where it names none, or several.
std::string named_image(const DicomItem& reference);

/// Images by these names; null where several have one.
std::map<std::string, const SourceImage*> images_by_name(const std::vector<SourceImage>& images);

/// The warning that a segmentation or contours (`path`) were made on other images than those that they are used with,
/// though both lie in one space; nothing where they were not, or where one of both does not say. `image`: what the
/// images are called.
std::optional<std::string> other_images(const std::filesystem::path& path, const ReferencedImages& referenced,
                                        const std::string& image, const std::string& series_uid,
                                        const std::vector<SourceImage>& images);

/// Checks a segmentation or contours (`path`) before they are used with an image. Returns the warning that they were
/// made on other images of the same space, as `other_images` says it, or are of another study and name none; nothing
/// where all is well. Errors: they are of another frame of reference than the image; one that says none is taken for
/// the same. `how`: behind "give the series that it was drawn on".
Result<std::optional<std::string>> check_scan(const std::filesystem::path& path, const std::string& frame_of_reference,
                                              const ReferencedImages& referenced,
                                              const std::filesystem::path& image_path, const Volume& image,
                                              const std::string& how = {});

}  // namespace homolog
