#pragma once

#include <vector>

#include "core/base/numbers/geometry.h"
#include "core/volume/contours.h"

namespace homolog {

/// A curve that somebody drew of an organ.
struct DrawnContour {
  Contour curve;         ///< LPS mm
  double off_mm = 0;     ///< how far it may lie off the boundary, standard deviation
  bool outside = false;  ///< it is not the boundary: the organ lies inside of it, somewhere
};

/// The plane of curves: a place in it, and its unit normal.
struct ContourPlane {
  Vec3 at = Vec3::Zero(), normal = Vec3::UnitZ();
};

/// A piece of a curve.
struct ContourSample {
  Vec3 at = Vec3::Zero();       ///< on the curve, LPS mm
  Vec3 outward = Vec3::Zero();  ///< unit, in the plane, away from the organ; zero where the curve is open
  Vec3 likely = Vec3::Zero();   ///< the likeliest place of the boundary: on the curve, or within one that lies outside
  int plane = -1;               ///< −1: the curve lies in no plane
  bool hole = false;            ///< the curve is the rim of a hole
  bool outside = false;         ///< the curve lies outside of the organ
  double length_mm = 0;
  double off_mm = 0;  ///< how far the boundary may lie from `likely`, standard deviation
};

/// Curves cut into pieces of about one length.
struct ContourSamples {
  std::vector<ContourSample> samples;
  std::vector<ContourPlane> planes;

  /// The likeliest places of the boundary, k×3.
  Points likely() const;
  /// Diagonal of the box around all curves, mm.
  double diagonal_mm() const;
};

/// Cuts curves into about `count` pieces in all, no fewer than eight a curve. If there are several closed curves in
/// a plane, one within another is the rim of a hole, whether all are combined by exclusive or or not; so is the inner
/// one of a keyhole, whose channel is left out, also where that is a slit of up to 0.1 mm.
/// A curve that lies outside is taken for a loose stroke, whose area is half as large again as the organ's: such
/// strokes of vertebral bodies had 1.3 to 1.8 times their area.
ContourSamples sampled_contours(const std::vector<DrawnContour>& drawn, std::size_t count);

}  // namespace homolog
