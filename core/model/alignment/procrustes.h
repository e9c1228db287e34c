#pragma once

#include <array>
#include <vector>

#include "core/base/numbers/geometry.h"

namespace homolog {

/// n vertices of M shapes: 3n×M, one shape a column as x y z of vertex 0, x y z of vertex 1, … (mm, LPS).
using ShapeMatrix = Eigen::MatrixXd;

inline Eigen::Map<const Points> points_of(const ShapeMatrix& shapes, Eigen::Index shape) {
  return {shapes.col(shape).data(), shapes.rows() / 3, 3};
}
inline Eigen::Map<const Points> points_of(const Eigen::VectorXd& shape) {
  return {shape.data(), shape.size() / 3, 3};
}

/// The differences that generalised Procrustes analysis takes out of the shapes.
enum class Alignment {
  similarity,  ///< translation, rotation and scale: every centroid size becomes their mean
  rigid,       ///< translation and rotation; size stays
  none
};
inline constexpr std::array alignment_names{"similarity", "rigid", "none"};

/// √ Σ ‖p − centroid‖² in mm.
double centroid_size_mm(const Points& points);

/// Generalised Procrustes analysis in place [Gower 1975], with the sizes of docs/models.md: shapes are centred on the
/// origin, scaled (or not), and rotated to their mean until the mean rests to 1e-10 of its size. The result is turned
/// as the first shape was. Never a reflection. Shapes without extent are only centred. Throws std::invalid_argument for
/// rows that are no multiple of 3 and for coordinates that are not finite.
void align(ShapeMatrix& shapes, Alignment alignment);

/// `points` aligned to `target` alone: centred on its centroid, turned, and scaled to its centroid size (similarity).
/// Throws std::invalid_argument where one has more points than the other.
Points aligned_to(const Points& points, const Points& target, Alignment alignment);

/// How much nearer `b` comes to `a` when it may be reflected: distance without ÷ distance with, both after a
/// similarity fit. Above 1 the mirror image fits better; 1 where both are flat.
double reflection_gain(const Points& a, const Points& b);

}  // namespace homolog
