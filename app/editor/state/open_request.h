#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/phantom/phantom.h"
#include "core/volume/volume_io.h"

namespace homolog {

/// A request to open files; empty parts are not asked for.
struct OpenRequest {
  std::filesystem::path case_file;
  std::string volume_source;  ///< beside a case: where its image lies now
  VolumeReadOptions volume_options;
  std::string other_source;        ///< a second volume: one of the two is the image, the other its label map
  std::string template_source;     ///< path, or a built-in template's name
  bool template_in_place = false;  ///< it was made on the image on the screen, and stays where it was made
  std::filesystem::path labels;
  std::vector<std::filesystem::path> contours;  ///< read when all else is open
  std::optional<std::pair<Organ, int>> demo;    ///< a phantom's subject, with its template placed
  std::shared_ptr<const Volume> beside;         ///< the image on the screen: a label map on its voxels is shown over it
};

}  // namespace homolog
