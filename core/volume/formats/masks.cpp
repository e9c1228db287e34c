#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/files/file_stem.h"
#include "core/base/processes/memory.h"
#include "core/volume/formats/formats.h"
#include "core/volume/labels/label_boxes.h"
#include "core/volume/labels/read_labels.h"
#include "core/volume/labels/soft_mask.h"
#include "core/volume/readers.h"

// A folder of single masks, as TotalSegmentator writes it: a file for each structure, which has the structure's name.
namespace homolog {
namespace fs = std::filesystem;

namespace {

bool is_mask_file(const fs::path& file) {
  return has_ending(file, {".nii.gz", ".nii", ".nrrd", ".mha", ".mgz", ".mgh"});
}

/// A mask: one label at most, in one frame. A soft one has its surface at the usual level.
Result<VolumeRead> read_one_mask(const fs::path& file) {
  auto read = read_volume(file);
  if (!read) return read;
  if (read->volume.frames == 1 && is_soft(read->volume, 0)) {
    if (auto soft = make_soft(read->volume, 0, usual_level); !soft) return fail(file.string(), soft.error().what);
    return read;
  }
  warn_of_soft_labels(file, read->volume, 0, read->warnings);
  if (read->volume.frames == 1 && read->other_layers.empty() && labels_of(read->volume).size() < 2) return read;
  return fail(file.parent_path().string(), "is a folder, and no single masks lie in it, since " +
                                               file.filename().string() +
                                               " holds several labels, frames or grey values; name one file of it");
}

/// The grid that holds two whose voxels coincide; none where it would be far larger than what masks of one scan need.
std::optional<VolumeGeometry> grid_of_both(const VolumeGeometry& grid, const std::array<int, 3>& offset,
                                           const VolumeGeometry& other) {
  constexpr double most_voxels = 1e9;
  VoxelBox box;
  double voxels = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    box.first[a] = std::min(0, offset[a]);
    box.last[a] = std::max(grid.dims[a], offset[a] + other.dims[a]) - 1;
    voxels *= box.last[a] - box.first[a] + 1;
  }
  if (voxels > most_voxels) return std::nullopt;
  return part_of_grid(grid, box);
}

using VoxelAt = std::array<int, 3>;

/// Works on each voxel of a part of a grid whose first one lies at `first`.
template <class Work>
void each_voxel(const VolumeGeometry& part, const VoxelAt& first, const Work& work) {
  std::size_t v = 0;
  for (int k = 0; k < part.dims[2]; ++k)
    for (int j = 0; j < part.dims[1]; ++j)
      for (int i = 0; i < part.dims[0]; ++i, ++v) work(v, VoxelAt{first[0] + i, first[1] + j, first[2] + k});
}

std::size_t index_in(const VolumeGeometry& grid, const VoxelAt& at) {
  return grid.index(at[0], at[1], at[2]);
}

bool is_in(const VolumeGeometry& grid, const VoxelAt& at) {
  for (std::size_t a = 0; a < 3; ++a)
    if (at[a] < 0 || at[a] >= grid.dims[a]) return false;
  return true;
}

/// Puts the mask's voxels into a layer as `value`, which grows as far as the mask goes; false where one of them has a
/// label there, or the voxels of both do not coincide. Errors: more memory than there is; `file`: whose mask it is.
Result<bool> put_into(Volume& layer, const Volume& mask, int value, const fs::path& file) {
  const auto offset = offset_in_grid(layer.geometry, mask.geometry);
  if (!offset) return false;
  const auto grid = grid_of_both(layer.geometry, *offset, mask.geometry);
  if (!grid) return false;
  VoxelAt old{}, first{};  // the places at which the layer and the mask begin in the new grid
  for (std::size_t a = 0; a < 3; ++a) {
    old[a] = std::max(0, -(*offset)[a]);
    first[a] = old[a] + (*offset)[a];
  }
  auto& voxels = std::get<std::vector<std::uint16_t>>(layer.data);
  return std::visit(
      [&](const auto& in) -> Result<bool> {
        bool overlaps = false;
        each_voxel(mask.geometry, *offset, [&](std::size_t v, const VoxelAt& at) {
          if (rounded_label(in[v]) != 0 && is_in(layer.geometry, at))
            overlaps = overlaps || voxels[index_in(layer.geometry, at)] != 0;
        });
        if (overlaps) return false;
        if (grid->dims != layer.geometry.dims) {
          const double bytes = sizeof(std::uint16_t) * static_cast<double>(grid->voxels());
          if (auto enough = check_memory(file, bytes); !enough) return fail(enough.error());
          std::vector<std::uint16_t> grown(grid->voxels());
          each_voxel(layer.geometry, old,
                     [&](std::size_t v, const VoxelAt& at) { grown[index_in(*grid, at)] = voxels[v]; });
          voxels = std::move(grown);
          layer.geometry = *grid;
        }
        each_voxel(mask.geometry, first, [&](std::size_t v, const VoxelAt& at) {
          if (rounded_label(in[v]) != 0) voxels[index_in(*grid, at)] = static_cast<std::uint16_t>(value);
        });
        layer.range_max = value;
        return true;
      },
      mask.data);
}

/// The layer that took the mask: the first in which it overlaps none, else one of its own. Masks whose voxels coincide
/// share a grid that holds them all, so that neighbours are seen as such.
Result<std::size_t> put_into_layers(const Volume& mask, int value, const fs::path& file, std::vector<Volume>& layers) {
  for (std::size_t layer = 0; layer < layers.size(); ++layer) {
    const auto put = put_into(layers[layer], mask, value, file);
    if (!put) return fail(put.error());
    if (*put) return layer;
  }
  Volume& own = layers.emplace_back();
  own.geometry = mask.geometry;
  own.data = std::vector<std::uint16_t>(mask.geometry.voxels());
  if (auto put = put_into(own, mask, value, file); !put) return fail(put.error());
  return layers.size() - 1;
}

Result<VolumeRead> read_masks(const fs::path& folder, const VolumeReadOptions& options) {
  const auto files = mask_files(folder);
  constexpr std::size_t most_files = 10000;
  if (files.size() > most_files)
    return fail(folder.string(), "holds more than " + std::to_string(most_files) +
                                     " images, which is no folder of single masks; name one file of it");
  VolumeRead result;
  result.segments_are_own = true;
  std::vector<Volume> layers;
  for (std::size_t k = 0; k < files.size(); ++k) {
    if (options.progress) options.progress->report(static_cast<double>(k) / static_cast<double>(files.size()));
    if (options.progress && options.progress->cancelled()) return fail(folder.string(), "was not read: cancelled");
    auto mask = read_one_mask(files[k]);
    if (!mask) return mask;
    result.warnings.insert(result.warnings.end(), mask->warnings.begin(), mask->warnings.end());
    const int value = static_cast<int>(k) + 1;
    const auto layer = put_into_layers(mask->volume, value, files[k], layers);
    if (!layer) return fail(layer.error());
    if (mask->volume.soft)
      if (auto soft = soft_segment(mask->volume, value, *layer)) result.soft.push_back(std::move(*soft));
    result.segmentation.add({.name = segment_name(file_stem(files[k])), .value = value, .layer = *layer});
  }
  if (layers.empty()) return fail(folder.string(), "holds no masks any more; read it again");
  if (layers.size() > 1)
    result.about_layers = folder.string() + ": its masks overlap or lie on grids of their own, so they are kept in " +
                          std::to_string(layers.size()) + " layers; --label names one";
  result.volume = std::move(layers.front());
  layers.erase(layers.begin());
  result.other_layers = std::move(layers);
  return result;
}

}  // namespace

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
