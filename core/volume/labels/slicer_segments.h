#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/volume/labels/segmentation.h"

namespace homolog {

/// The segments that 3D Slicer describes in an NRRD header, by its pairs KEY:=VALUE ("Segment0_Name", …). Older ones
/// give neither value nor layer: then each segment is label 1 of a layer of its own. `layers`: how many there are.
/// Warnings name what cannot be followed, which is left out.
Segmentation slicer_segments(const std::filesystem::path& path,
                             const std::vector<std::pair<std::string, std::string>>& pairs, std::size_t layers,
                             std::vector<std::string>& warnings);

}  // namespace homolog
