#pragma once

#include <string>
#include <vector>

#include "core/base/numbers/geometry.h"
#include "core/model/alignment/procrustes.h"

namespace homolog {

/// One structure of shapes that are made of several: its vertices and triangles are those of its own mesh, in its
/// order, after those of the structures before it.
struct StructurePart {
  std::string name;
  Eigen::Index first_vertex = 0, vertices = 0;
  Eigen::Index first_triangle = 0, triangles = 0;  ///< no triangles where the shapes are points alone
};

/// The poses of structures in M shapes: against the mean place of each, in the frame of the aligned shapes. A turn is
/// about the structure's middle.
struct StructurePoses {
  /// A structure of a shape: middle, turn and size against the mean place.
  static constexpr Eigen::Index numbers = 7;  ///< offset x y z (mm), turn x y z (axis times angle, degrees), log scale
  bool apart = false;                         ///< the model's modes are without them; else within them
  Eigen::MatrixXd values;                     ///< 7S×M, the structures one after the other
  Eigen::VectorXd radius_mm;                  ///< S: root mean square distance of the mean's vertices to their middle
  Eigen::MatrixXd basis;                      ///< 7S×r, orthonormal axes of in_mm(values)
  Eigen::VectorXd variances;                  ///< r, mm², with 1/(M−1), descending

  /// The values with each turn (in radians) and log scale times its structure's radius: about what its vertices move.
  Eigen::MatrixXd in_mm() const;
};

/// A structure of a training shape that is not its own: the joint model of the others expects it so.
struct CompletedStructure {
  Eigen::Index shape = 0;  ///< column of the training set
  Eigen::Index part = 0;
  double expected_error_mm = 0;  ///< root mean square over vertices, of complete shapes that were completed so
  double mean_error_mm = 0;      ///< the same where the mean of the others is taken in its place
};

/// The part of this name, in any case; null where there is none.
const StructurePart* part_named(const std::vector<StructurePart>& parts, const std::string& name);

/// The rows of one structure, 3n_k×M.
ShapeMatrix rows_of(const StructurePart& part, const ShapeMatrix& shapes);

/// The triangles of one structure, numbered from its own first vertex.
Triangles triangles_of(const StructurePart& part, const Triangles& triangles);

}  // namespace homolog
