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

/// Makes a label map of a segmentation whose "frames" are layers of segments, and adds to `read.segmentation` what its
/// header does not describe. Segments that nowhere overlap and have labels of their own become one label map; else
/// every layer stays one. `read.about_layers` says which.
void take_layers(const std::filesystem::path& path, VolumeRead& read);

/// The segments that `asked` names [asked_segments]. If a map has layers, `read.volume` becomes the label map in
/// which they lie, whatever layers they come from. An empty `asked` names the only label there is. Errors: those of
/// asked_segments; nothing asked for, and several there.
Result<std::vector<Segment>> choose_segments(const std::filesystem::path& path, const std::string& asked,
                                             VolumeRead& read);

/// Gives the voxels of all these segments one value in a frame, so that it stands for their union: that of the first
/// that occurs there, or of the first where none does.
int unite_segments(Volume& volume, std::span<const Segment> segments, int frame);

}  // namespace homolog
