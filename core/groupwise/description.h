#pragma once

#include <Eigen/Core>

namespace homolog {

/// The numbers that describe a set of M shapes: a column a shape, the rows' units chosen so that all rows count alike.
using Descriptions = Eigen::MatrixXd;

/// How long the set is to describe: Σ ½ log₂(1 + λ/α) bits, λ the variances of the set's modes (the mean over the
/// rows), α = `precision`². A mode that varies by less than the precision costs next to nothing. Up to a constant this
/// is the entropy that ShapeWorks minimises [Cates 2007], and the length of [Davies 2002] with modes coded to that
/// precision.
double description_bits(const Descriptions& set, double precision);

/// Column k: where shape k costs least while the others stay. The logarithm is concave in the set's scatter, so its
/// tangent bounds the cost from above, and each step to that place makes the set shorter to describe. A large
/// `precision` gives the mean of the others, a small one their nearest combination. Needs two shapes.
Descriptions expected_from_others(const Descriptions& set, double precision);

}  // namespace homolog
