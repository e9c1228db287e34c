#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/volume/volume_io.h"

namespace homolog {

// Things shared by the verbs that write a label map on the grid of an image: convert, label-map.

/// Whether a file of that name is one of DICOM.
bool is_dicom_name(const std::filesystem::path& path);
/// Writes a label map by the ending of its name; one of DICOM refers to a series, of several in a folder to that of
/// `series_uid`. Gives warnings.
Result<std::vector<std::string>> write_labels(const VolumeRead& map, const std::filesystem::path& out,
                                              const std::filesystem::path& series, Progress& progress,
                                              const std::string& record, const std::string& series_uid);

/// The image whose grid a label map gets.
struct LikeImage {
  std::filesystem::path path;
  bool resample = false;
  std::optional<std::string> series{};  ///< by --series; no value: the verb has no such option
};
/// The same with the folder of the series that is meant in place of a study's: that of --series, else that of what the
/// map was made on [folder_of_series].
LikeImage like_of(LikeImage like, const ReferencedImages& made_on);
/// The volume whose grid a label map gets; of several series in a folder that of --series, else that of the images that
/// the map was made on.
Result<VolumeRead> read_like(const LikeImage& like, const ReferencedImages& made_on, Progress& progress);

}  // namespace homolog
