#pragma once

#include <map>
#include <string>

#include "core/case/document.h"
#include "core/fit/boundary.h"

namespace homolog {

struct FoundPlacement {
  Similarity placement;
  double distance_mm = 0;  ///< root mean square of closest distances between samples, both directions
};

/// Which rotations are looked at.
enum class Orientation {
  patient,  ///< those within 60° of the patient's axes: the best overlap alone is anatomically wrong too often
  any       ///< all proper ones: for a scan whose axes are wrong
};

/// The similarity that lays a template on a boundary without a hand: position and size by moments, rotation from the
/// patient's axes and from the moments' axes, whose order and signs the patient's axes decide; each refined by closest
/// points in both directions, the nearer one taken. Never a reflection. `landmarks`: named places on the organ (LPS
/// mm), those the template names too decide the placement from the third on.
FoundPlacement find_placement(const Template& reference, const Boundary& boundary,
                              const std::map<std::string, Vec3>& landmarks, Orientation orientation);

/// `start` refined by closest points in both directions, turned by at most 60°.
FoundPlacement refine_placement(const Template& reference, const Boundary& boundary, const Similarity& start);

/// Whether the mirrored template, placed by a similarity alone, lies clearly nearer to the boundary than the template:
/// the organ of the other side. Organs that are their own mirror images never look mirrored.
bool looks_mirrored(const Template& reference, const Boundary& boundary);

}  // namespace homolog
