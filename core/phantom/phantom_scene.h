#pragma once

#include <string>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/mesh/mesh_io.h"
#include "core/volume/labels/segmentation.h"
#include "core/volume/volume.h"

namespace homolog {

/// One structure of a phantom that shows several.
struct SceneStructure {
  std::string name;  ///< the name of TotalSegmentator where it has one: "vertebrae_L3", "disc_L3_L4", "sacrum"
  int value = 0;     ///< its label in the label map
  MeshFile truth;    ///< its true surface with its landmarks, LPS mm
};

/// A made-up subject with several structures. Structures of one name share one triangulation in all subjects, and
/// vertex i is the same anatomical place in each; so do all vertebrae, and all discs, among each other.
struct PhantomScene {
  Volume image;      ///< CT-like
  Volume label_map;  ///< on the image's grid
  Segmentation segmentation;
  std::vector<SceneStructure> structures;
};

/// A lumbar spine: the last thoracic vertebra, the lumbar ones, the discs between them, the sacrum. Most subjects have
/// five lumbar vertebrae, some four or six; the number fixes it. Subject 0 is the mean. The same number gives the same
/// voxels on every machine. `spacing_mm` ≤ 0 takes 1 mm. `progress` can cancel it: what is given then is not whole.
PhantomScene make_spine_phantom(int subject, double spacing_mm = 0, const Progress* progress = nullptr);

/// The structures of make_spine_phantom alone, without the cost of the images.
std::vector<SceneStructure> spine_phantom_truth(int subject);

}  // namespace homolog
