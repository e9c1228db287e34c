#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/volume/volume_io.h"

namespace homolog {

/// read_volume for a file that is taken as a label map: warns where values are no whole numbers, as those of a mask
/// with soft edges; labels_of rounds them.
Result<VolumeRead> read_labels(const std::filesystem::path& path, const VolumeReadOptions& options = {});

/// Warns where finite values of a frame are no whole numbers, and names the first of them.
void warn_of_soft_labels(const std::filesystem::path& path, const Volume& labels, int frame,
                         std::vector<std::string>& warnings);

/// Makes a label map of a segmentation whose "frames" are layers of segments. Segments that nowhere overlap and have
/// labels of their own become one label map; else every layer stays one. `read.warnings` says which.
void take_layers(const std::filesystem::path& path, VolumeRead& read);

/// Makes `read.volume` the label map of one layer in which these labels lie, whatever layers they come from; where
/// `labels` are none, of the only label there is. Does nothing where there are no layers. Errors: a label that lies in
/// several layers, so that it does not tell which segment is meant; none given, and several there.
Result<void> choose_layer(const std::filesystem::path& path, std::span<const int> labels, VolumeRead& read);

}  // namespace homolog
