#pragma once

#include <map>
#include <optional>
#include <string>

#include "core/adapt/boundary/boundary.h"
#include "core/adapt/boundary/closest_points.h"
#include "core/template/template.h"

namespace homolog {

/// Which rotations are looked at.
enum class Orientation {
  patient,  ///< those within 60° of the patient's axes: the best overlap alone is anatomically wrong too often
  any       ///< all proper ones: for a scan whose axes are wrong
};

/// What is known of a placement beforehand.
struct PlacementHints {
  std::map<std::string, Vec3> landmarks;  ///< named places on the organ, LPS mm; names the template lacks are left out
  Orientation orientation = Orientation::patient;
  std::optional<Similarity> start;  ///< near which to look, instead of the patient's axes; turned by at most 60°
};

/// The similarity that lays a template on a boundary without a hand: the likeliest, by closest points in both
/// directions, three or more landmarks, and the patient's axes. Starts are position and size by moments, with the
/// rotation of the patient's axes, of the moments' axes (whose order and signs the patient's axes decide) and of the
/// landmarks. So landmarks decide of the rotation what they determine well; the surface and the patient's axes decide
/// the rest. A landmark that contradicts the surface and the others is not trusted. Never a reflection.
Placed find_placement(const Template& the_template, const Boundary& boundary, const PlacementHints& hints = {});

/// Whether the mirrored template, placed by a similarity alone, lies clearly nearer to the boundary than the template:
/// the organ of the other side. Organs that are their own mirror images never look mirrored.
bool looks_mirrored(const Template& the_template, const Boundary& boundary,
                    Orientation orientation = Orientation::patient);

}  // namespace homolog
