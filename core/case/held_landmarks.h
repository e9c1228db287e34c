#pragma once

#include <array>
#include <string>

#include "core/case/document.h"

namespace homolog {

// A placed landmark that the mesh has come to meet is held: its triangle there is confirmed, so that strokes leave
// it. Only where the structure says so (LandmarkRules::hold).

/// How the mesh lies to one landmark of the template.
struct LandmarkHold {
  bool placed = false;     ///< it is placed in the image
  double distance_mm = 0;  ///< distance from the mesh to its place; 0 where it has none
  bool met = false;        ///< placed, and no farther than 2 mm or the longest edge of its triangle
  bool held = false;       ///< the mesh is confirmed there
};
LandmarkHold landmark_hold(const Template& the_template, std::size_t landmark, const Shape& shape);

/// Holds the mesh at a landmark, or lets it go again; what else is confirmed around it stays.
void hold_landmark(const Template& the_template, std::size_t landmark, bool hold, Shape& shape);

/// The confirmed vertices without the triangles that landmarks hold; null: nothing is.
std::shared_ptr<const VertexScalars> confirmed_without_landmarks(const ShapeView& view);

/// After an edit of a structure, at the shown frame: holds the mesh at every landmark that it has come to meet, and
/// lets it go where it no longer does. A landmark that was released by hand stays free.
void settle_landmarks(const Structure& before, Structure& after, int frame);

}  // namespace homolog
