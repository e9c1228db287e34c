#pragma once

#include <string>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/mesh/mesh_io.h"
#include "core/volume/volume.h"

namespace homolog {

enum class Organ { kidney, vertebra, ventricle };

/// A made-up subject of an organ. All subjects of one organ share one triangulation, and vertex i is the same
/// anatomical place in each of them: the true landmark correspondence.
struct PhantomSubject {
  Volume image;                     ///< CT-like (kidney, vertebra) or cine MR-like with 20 frames (ventricle)
  Volume label_map;                 ///< on the image's grid and frames; 1 the organ (ventricle: cavity)
  std::vector<MeshFile> truth;      ///< the true surface of each frame (one for a static organ), LPS mm
  std::vector<Landmark> landmarks;  ///< named features at their true places in frame 0
};

/// Subject `number` (0 is the mean shape) of an organ; the same number gives the same voxels on every machine.
/// `spacing_mm` ≤ 0 takes the organ's own voxel size (the ventricle's slices stay 8 mm thick). `progress` can cancel
/// it: what is given then is not whole.
PhantomSubject make_phantom(Organ organ, int number, double spacing_mm = 0, const Progress* progress = nullptr);

/// The `truth` of make_phantom alone, without the cost of the images.
std::vector<MeshFile> phantom_truth(Organ organ, int number);

/// The built-in template of an organ, in its own frame around the origin (axes parallel to the patient's): closed
/// (ventricle: open at the base), ≈ 2,500 vertices, with named landmarks and stiffness factors.
MeshFile built_in_template(Organ organ);

/// The organ of a name ("kidney", "vertebra", "ventricle").
Result<Organ> organ_from_name(const std::string& name);
const char* organ_name(Organ organ);

}  // namespace homolog
