#pragma once

#include <string>
#include <vector>

#include "core/phantom/phantom_scene.h"

namespace homolog::phantom {

/// A subject's spine, posed and deformed (LPS mm).
struct SpineMeshes {
  std::vector<SceneStructure> structures;  ///< from the head down: a vertebra, the disc below it, the next one, …
  std::vector<MeshFile> beyond;            ///< bones and discs above, which are seen but belong to no structure
  std::vector<Vec3> bodies;  ///< the middles of the bodies, of `beyond` too; then a place low in the sacrum
  std::vector<Vec3> canal;   ///< places along the middle of the canal, from the head down
};

/// If bones would touch, the subject gets less of the variation that is theirs alone.
SpineMeshes spine_meshes(int subject);

}  // namespace homolog::phantom
