#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/base/file_stem.h"
#include "core/volume/formats/formats.h"
#include "core/volume/read_labels.h"
#include "core/volume/readers.h"

// A folder of single masks, as TotalSegmentator writes it: a file for each structure, which has the structure's name.
namespace homolog {
namespace fs = std::filesystem;

namespace {

bool is_mask_file(const fs::path& file) {
  return has_ending(file, {".nii.gz", ".nii", ".nrrd", ".mha", ".mgz", ".mgh"});
}

std::vector<fs::path> mask_files(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (auto entry = fs::directory_iterator(folder, error); !error && entry != fs::directory_iterator();
       entry.increment(error))
    if (std::error_code ignored;
        entry->is_regular_file(ignored) && !is_hidden(entry->path()) && is_mask_file(entry->path()))
      files.push_back(entry->path());
  std::sort(files.begin(), files.end());
  return files;
}

/// A mask: one label at most, in one frame.
Result<VolumeRead> read_one_mask(const fs::path& file) {
  auto read = read_labels(file);
  if (!read) return read;
  if (read->volume.frames == 1 && read->other_layers.empty() && labels_of(read->volume).size() < 2) return read;
  return fail(file.string(),
              "holds several labels, frames or grey values, so that its folder is no folder of single masks; name "
              "one file of it");
}

/// Puts the mask's voxels into a layer as `value`, unless one of them has a label there or the grid is another.
bool fits_into(Volume& layer, const Volume& mask, int value) {
  if (!same_grid(layer.geometry, mask.geometry)) return false;
  auto& voxels = std::get<std::vector<std::uint16_t>>(layer.data);
  return std::visit(
      [&](const auto& in) {
        const auto is_set = [](const auto voxel) { return rounded_label(voxel) != 0; };
        for (std::size_t v = 0; v < in.size(); ++v)
          if (is_set(in[v]) && voxels[v] != 0) return false;
        for (std::size_t v = 0; v < in.size(); ++v)
          if (is_set(in[v])) voxels[v] = static_cast<std::uint16_t>(value);
        layer.range_max = value;
        return true;
      },
      mask.data);
}

/// The layer that took the mask: the first in which it overlaps none, else one of its own.
std::size_t put_into_layers(const Volume& mask, int value, std::vector<Volume>& layers) {
  for (std::size_t layer = 0; layer < layers.size(); ++layer)
    if (fits_into(layers[layer], mask, value)) return layer;
  Volume& own = layers.emplace_back();
  own.geometry = mask.geometry;
  own.data = std::vector<std::uint16_t>(mask.geometry.voxels());
  fits_into(own, mask, value);
  return layers.size() - 1;
}

Result<VolumeRead> read_masks(const fs::path& folder, const VolumeReadOptions& options) {
  const auto files = mask_files(folder);
  constexpr std::size_t most_files = 10000;
  if (files.size() > most_files)
    return fail(folder.string(), "holds more than " + std::to_string(most_files) +
                                     " images, which is no folder of single masks; name one file of it");
  VolumeRead result;
  std::vector<Volume> layers;
  for (std::size_t k = 0; k < files.size(); ++k) {
    if (options.progress) options.progress->report(static_cast<double>(k) / static_cast<double>(files.size()));
    if (options.progress && options.progress->cancelled()) return fail(folder.string(), "was not read: cancelled");
    auto mask = read_one_mask(files[k]);
    if (!mask) return mask;
    result.warnings.insert(result.warnings.end(), mask->warnings.begin(), mask->warnings.end());
    const int value = static_cast<int>(k) + 1;
    const std::size_t layer = put_into_layers(mask->volume, value, layers);
    result.segmentation.add({.name = segment_name(file_stem(files[k])), .value = value, .layer = layer});
  }
  if (layers.empty()) return fail(folder.string(), "holds no masks any more; read it again");
  if (layers.size() > 1)
    result.warnings.push_back(folder.string() +
                              ": its masks overlap or lie on grids of their own, so they are kept in " +
                              std::to_string(layers.size()) + " layers; --label names one");
  result.volume = std::move(layers.front());
  layers.erase(layers.begin());
  result.other_layers = std::move(layers);
  return result;
}

}  // namespace

const VolumeFormat formats::masks{.name = "single masks",
                                  .endings = {},
                                  .written = {},
                                  .in_folder = "single masks in NIfTI, NRRD, MetaImage or MGH",
                                  .note =
                                      "a folder with a file for each structure, of its name, each on its own grid "
                                      "(TotalSegmentator), where one label map is taken",
                                  .recognises = is_mask_file,
                                  .read = read_masks};

}  // namespace homolog
