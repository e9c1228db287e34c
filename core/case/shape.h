#pragma once

#include <map>
#include <memory>
#include <string>

#include "core/template/template.h"

namespace homolog {

/// One frame's mesh in the case. All points LPS mm.
struct Shape {
  Similarity placement;
  Similarity before_landmarks;              ///< the placement without them; it decides what they leave open
  std::map<std::string, Vec3> landmarks;    ///< the places of named landmarks in the image
  std::shared_ptr<const Points> placed;     ///< the template placed, not warped: quality compares with it
  std::shared_ptr<const Points> reference;  ///< R: `placed`, warped to the landmarks where asked; else the same pointer
  std::shared_ptr<const Points> points;     ///< P: the deformed mesh
  std::shared_ptr<const VertexScalars> confirmed;  ///< 0 free … 1 held where it is; null: all free
  std::shared_ptr<const VertexScalars> decided;    ///< 0 … 1: see below; null: nothing is
  std::shared_ptr<const Points> unaided;           ///< see unaided_points; null: no model moved anything
  int strokes = 0;                                 ///< edits of P since it was last equal to R
  int drawn_strokes = 0;  ///< `strokes` at the last fit of the template to contours; if equal, P is by contours alone
  /// How far strokes have carried each vertex since the last fit, 0 … 1: so far a snap holds it. Null: nothing is
  /// held. A released vertex is let go.
  std::shared_ptr<const VertexScalars> pulled;
  int pulls = 0;  ///< how many strokes that were
  /// P without what snaps moved since the last fit or stroke: the shape that a snap keeps to, so that snaps do not
  /// add up. Null: P itself.
  std::shared_ptr<const Points> unsnapped;
  std::shared_ptr<const Points> carried;          ///< P as it came from other frames of a cine; null: it did not
  std::string doubt;                              ///< why what was carried here has to be looked at; empty: it need not
  std::shared_ptr<const VertexScalars> doubt_mm;  ///< the last fit's doubt [FitResult::doubt_mm]; null: there is none
  /// 1 where the scan lacks the vertex's place, else 0 [FitResult::outliers]. The last fit says it, where that was one
  /// to an organ that lacks parts; null: it was none.
  std::shared_ptr<const VertexScalars> outlier;
};

/// The part of `doubt_mm` that is still in doubt: nothing where a vertex is confirmed. Empty where there is no
/// doubt_mm.
VertexScalars doubt_left_mm(const Shape& shape);

/// The share of its label that a frame's mesh still lacks, since the template that it is lacks it [Template]: 0 once
/// edits have given the mesh at least half of that volume.
double missing_share_of(const Template& the_template, const Shape& shape);

/// Whether a person made a frame's mesh what it is: it was edited or confirmed since it came from other frames.
bool frame_is_known(const Shape& shape);

/// How well the place of each vertex is known, 0 … 1. A confirmed vertex is known as far as it is confirmed. A vertex
/// whose `decided` is at least 0.6 is fully known. `decided` is how far strokes have carried the vertex; it is 1 where
/// a fit or a snap moved it. Moves by a shape model do not count.
VertexScalars known_vertices(const Shape& shape);

/// The shape without the help of a shape model, n×3, LPS mm. Known vertices are where they are. All others are where
/// the shape would be after the edits alone. Help always starts from this shape, so it does not add up from edit to
/// edit.
Points unaided_points(const Shape& shape);

}  // namespace homolog
