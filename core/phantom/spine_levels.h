#pragma once

#include <string>
#include <vector>

#include "core/base/numbers/geometry.h"

namespace homolog::phantom {

/// How a level of the spine differs from the mean vertebra of spine.h. Scales are of that vertebra's lengths.
struct LevelShape {
  double width = 1;  ///< the body's width
  double depth = 1;  ///< the body's depth, from front to back
  double height = 1;
  double wedge_deg = 0;    ///< angle between the endplates; positive: higher in front
  double arch_top = 1;     ///< width of the arch at its upper joints
  double arch_bottom = 1;  ///< width of the arch at its lower joints
  double transverse = 1;   ///< length of the transverse processes
  double spinous = 1;      ///< length of the spinous process
  double drop_mm = 0;      ///< how much lower the spinous process ends

  /// The place in this vertebra of a place of the mean one. Smooth, and nowhere folded.
  Vec3 carried(const Vec3& p) const;
};

struct SpineLevel {
  std::string name;  ///< "vertebrae_L3", "sacrum"
  LevelShape shape;
};

/// The joint where two levels meet.
struct SpineJoint {
  double lordosis_deg = 0;  ///< between the two levels' frames; positive: the lower one is tilted forwards
  /// How the subject's joint is turned besides, about the joints of the arches: forwards, sideways, about the spine.
  double bend_deg = 0, lateral_deg = 0, axial_deg = 0;
  double disc_mm = 9;  ///< height of the disc in its middle
};

/// The spine of one subject, from the head down. The first level is only partly in the image and has no truth.
struct SpinePlan {
  std::vector<SpineLevel> levels;
  std::vector<SpineJoint> joints;  ///< between a level and the next
};

constexpr std::uint64_t spine_seed = 0x7370696e65;  // "spine"

/// How many lumbar vertebrae a subject has: five, in about one of six four, in about one of six six.
int lumbar_levels(int subject);
/// `amount`: 1 for all of the subject's variation, 0 for none; subject 0 has none.
SpinePlan spine_plan(int subject, double amount);

}  // namespace homolog::phantom
