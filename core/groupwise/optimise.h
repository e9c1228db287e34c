#pragma once

#include <string>
#include <vector>

#include "core/groupwise/slide_together.h"
#include "core/mesh/mesh_io.h"
#include "core/model/training_set.h"

namespace homolog {

/// How good a set is: its description lengths, and the measures of its model [docs/models.md].
struct SetFigures {
  double bits = 0, position_bits = 0;
  int modes = 0;  ///< the number of modes for the following; 0 where there are too few shapes to measure
  double compactness = 0, generalisation_rms = 0, specificity_rms = 0;
};

/// A set whose vertices slid along the shapes' surfaces.
struct OptimisedSet {
  ShapeMatrix shapes;  ///< 3n×M, each in the frame that it was given in, mm
  SetFigures before, after;
  std::vector<double> largest_slide_mm;  ///< each shape's largest slide
  double surface_moved_mm = 0;           ///< the largest distance of a shape's two surfaces, either way
  std::size_t turned_triangles = 0;      ///< turned triangles of all shapes, against those that were given
};

/// Which vertices of a shape an optimisation must leave alone: those that a case confirms (its array `confirmed`), and
/// with `landmarks` the corners of the triangle at each named landmark. n values, 0 free; empty: all free.
VertexScalars held_vertices(const MeshFile& shape, const Topology& topology, bool landmarks);

/// slide_together of a training set, with the figures before and after. Errors: shapes of points alone; those of
/// slide_together.
Result<OptimisedSet> optimise_set(const TrainingSet& set, const GroupwiseOptions& options);

}  // namespace homolog
