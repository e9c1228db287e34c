#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/volume/volume_io.h"

namespace homolog {

/// All that the program knows of an image format. Each has one of these in the source of this folder that is named like
/// it.
struct VolumeFormat {
  std::string name;                  ///< its name in sentences and in docs/formats.md
  std::vector<std::string> endings;  ///< the endings of its files' names, in lower case
  std::vector<std::string> written;  ///< those that write_volume takes, the usual one first; none where it writes none
  std::string in_folder;             ///< the content of a folder of it, in sentences; empty where a file holds it all
  std::string note;                  ///< a remark for docs/formats.md

  /// Whether a file is of this format by its content. Null where the ending of its name decides; where it is not null,
  /// the endings are those that file dialogs show.
  bool (*recognises)(const std::filesystem::path& file) = nullptr;
  /// Takes a file or, where `in_folder` is not empty, a folder. It checks what the header claims with `check_claim`
  /// before it takes memory, and reads voxels with `read_run` (core/volume/readers.h).
  Result<VolumeRead> (*read)(const std::filesystem::path& path, const VolumeReadOptions& options);
  Result<void> (*write)(const Volume& volume, const std::filesystem::path& path, const std::string& record,
                        Progress* progress) = nullptr;
  bool keeps_record = false;  ///< the image keeps the record that `write` is given; else a file beside it does
};

namespace formats {
extern const VolumeFormat dicom, nifti, nrrd, metaimage, mgh, stack, masks;
}

/// The image formats, in the order in which sentences list them and in which a folder is looked through for them.
inline constexpr std::array volume_formats{&formats::dicom, &formats::nifti, &formats::nrrd, &formats::metaimage,
                                           &formats::mgh,   &formats::stack, &formats::masks};

/// The endings of all formats' names: `endings` or `written`.
inline std::vector<std::string> volume_format_endings(std::vector<std::string> VolumeFormat::*which) {
  std::vector<std::string> all;
  for (const VolumeFormat* format : volume_formats)
    all.insert(all.end(), (format->*which).begin(), (format->*which).end());
  return all;
}

/// The endings of names that a label map without layers can be written under.
inline std::vector<std::string> label_map_endings() {
  std::vector<std::string> all = volume_format_endings(&VolumeFormat::written);
  all.insert(all.end(), formats::mgh.endings.begin(), formats::mgh.endings.end());
  return all;
}

/// Writes the first frame of a label map as FreeSurfer has it, with names and colours in its table. Errors: labels
/// below 0, a place that single precision does not hold, the disk, cancelled.
Result<void> write_mgh_labels(const Volume& map, const Segmentation& names, const std::filesystem::path& path,
                              const std::string& record, Progress* progress);

}  // namespace homolog
