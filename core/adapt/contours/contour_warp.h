#pragma once

#include <map>
#include <memory>
#include <string>

#include "core/adapt/contours/contour_target.h"
#include "core/template/template.h"

namespace homolog {

/// A template carried smoothly to curves.
struct ContourWarp {
  Points points;            ///< n×3, LPS mm
  VertexScalars deviation;  ///< n: how far a place may lie off along its normal, standard deviation, mm
};

/// The displacement of space that is most likely given the curves [Lüthi 2018, §4.1: Gaussian-process regression]: at
/// each piece of a curve it is known along the mesh's normal. Between the curves it goes on as organs differ: by
/// stretches and shears of the whole, and by wide and by finer bumps. `placed`: n×3, the template under its similarity.
/// `landmarks`: k places of it and where they belong, each of noise `landmark_mm`.
ContourWarp warp_to_contours(const std::shared_ptr<const Topology>& topology, const Points& placed,
                             const ContourTarget& target, const Points& landmarks_from, const Points& landmarks_to,
                             double landmark_mm);

}  // namespace homolog
