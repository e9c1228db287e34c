#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/mesh/colours.h"
#include "core/volume/labels/segmentation.h"
#include "core/volume/volume.h"

namespace homolog {

/// One layer of a label map. Layers overlap.
struct LabelMapLayer {
  std::shared_ptr<const Volume> volume;  ///< null without one
  std::vector<int> values;               ///< without 0
  std::map<int, double> sizes_mm;        ///< sizes of each and of every_label together [organ_size_mm]
  std::map<int, std::string> names;
  std::shared_ptr<const std::map<int, Rgb>> colours;  ///< the colours that the map gives; null where it gives none
};

/// The map's segments of the layer's labels.
inline Segmentation segmentation_of(const LabelMapLayer& layer) {
  Segmentation known;
  for (const auto& [value, name] : layer.names) known.add({.name = name, .value = value});
  return known;
}

/// The frame of a label map that stands for one of the case: the same, or its last where it has fewer.
inline int frame_of_map(const Volume& labels, int frame) {
  return std::min(frame, labels.frames - 1);
}

}  // namespace homolog
