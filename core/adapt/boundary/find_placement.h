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

/// Things known of a placement beforehand.
struct PlacementHints {
  std::map<std::string, Vec3> landmarks;  ///< named places on the organ, LPS mm; names the template lacks are left out
  Orientation orientation = Orientation::patient;
  std::optional<Similarity> start;       ///< near which to look, instead of the patient's axes; turned by at most 60°
  bool partial = false;                  ///< the boundary may lack parts of the organ, or have what is not the organ's
  bool cut_template = false;             ///< the template lacks parts of the organ; it counts as partial
  std::optional<double> size_deviation;  ///< standard deviation of the logarithm of the scale; none: little is known
};

/// The most likely similarity that places a template on a boundary automatically. It weighs closest points in both
/// directions, three or more landmarks, and the patient's axes. Position and size start from moments. The rotation
/// starts from the patient's axes, from the moments' axes (their order and signs from the patient's axes), and from the
/// landmarks. Landmarks decide the part of the rotation that they determine well; the surface and the patient's axes
/// decide the rest. A landmark that contradicts the surface and the others is not trusted. Never a reflection.
Placed find_placement(const Template& the_template, const Boundary& boundary, const PlacementHints& hints = {});

/// The same where only some places on the organ's surface are known (k×3, LPS mm), as on contours in a few slices. They
/// are weighed in one direction: how far each lies from the template. `partial` and `cut_template` are left out.
Placed find_placement(const Template& the_template, const Points& places, const PlacementHints& hints = {});

/// How else an organ may lie against its template, and where the template's vertices lie then (n×3, LPS mm).
struct OtherLie {
  bool half_turned = false;  ///< turned by half a turn about the z axis, as RAS is against LPS; else its mirror image
  Points points;             ///< placed by a similarity alone
};

/// Whether the template's mirror image, or with `turns` the template turned from RAS to LPS, places itself on the
/// boundary clearly better than the template. The measure is the likelihood of find_placement: it counts the distances
/// of both surfaces and the turn against the patient's axes, since kidneys are alike to their mirror images turned by
/// 60°. None where neither is clearly likelier, so organs that are their own mirror images never look mirrored.
/// `turns` has sense only where the patient's axes count. `partial`: the boundary may lack parts, so only how far it
/// lies from each counts; a cut femur or hip of the other side is then found in about three of four cases.
std::optional<OtherLie> other_lie(const Template& the_template, const Boundary& boundary,
                                  Orientation orientation = Orientation::patient, bool turns = true,
                                  bool partial = false);

}  // namespace homolog
