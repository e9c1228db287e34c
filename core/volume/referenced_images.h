#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/volume/volume_io.h"

namespace homolog {

/// The warning that a segmentation or contours (`path`) were made on other images than those that they are used with,
/// though both lie in one space; nothing where they were not, or where one of both does not say. `image`: what the
/// images are called.
std::optional<std::string> other_images(const std::filesystem::path& path, const ReferencedImages& referenced,
                                        const std::string& image, const std::string& series_uid,
                                        const std::vector<std::string>& instance_uids);
std::optional<std::string> other_images(const std::filesystem::path& path, const ReferencedImages& referenced,
                                        const std::filesystem::path& image_path, const Volume& image);

/// Errors: a segmentation or contours (`path`) of another frame of reference than the image that they are used with;
/// one that says none is taken for the same. `how`: behind "give the series that it was drawn on".
Result<void> check_same_space(const std::filesystem::path& path, const std::string& frame_of_reference,
                              const std::filesystem::path& image_path, const Volume& image,
                              const std::string& how = {});

}  // namespace homolog
