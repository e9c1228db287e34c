#pragma once

#include <string>
#include <vector>

#include "core/adapt/allowed_shapes.h"
#include "core/adapt/annealing.h"
#include "core/adapt/image/edge_search.h"
#include "core/base/processes/progress.h"
#include "core/base/result.h"

namespace homolog {

struct SnapOptions {
  EdgeOptions edges;
  /// 0…1: how much the image decides; at 0 nothing moves.
  double strength = 1;
  Progress* progress = nullptr;
};

/// The start of a snap. All n×3 in LPS mm.
struct SnapStart {
  Mesh mesh;                ///< P⁰
  Points placed;            ///< the template as placed: what "turned" is measured against
  VertexScalars stiffness;  ///< factors
  VertexScalars free;       ///< 0 held exactly … 1 free, per vertex; confirmed ones are held
  Points rest{};            ///< the shape that the stiffness keeps to, n×3; empty: that of the mesh
  std::vector<Pin> pins{};  ///< places that points of free triangles go to, whatever the image shows
};

struct SnapResult {
  Points points;
  VertexScalars confidence;           ///< per vertex 0…1: how clear its edge is where the mesh lies now
  std::vector<std::int32_t> unseen;   ///< free vertices beyond the scan: they follow the others
  double mean_confidence = 0;         ///< over the free vertices that the scan shows
  double moved_mm = 0;                ///< mean over the free vertices
  bool doubtful = false;              ///< the image shows too little of a boundary here to trust the result
  std::vector<std::string> warnings;  ///< each a sentence
};

/// Draws a mesh to the boundary that an image shows. Force targets are looked for along the normals and weighed by
/// their confidence. Eq. 3 [Erdt 2009, §2.2] is solved repeatedly while the stiffness falls; its reference is P⁰,
/// carried along by a similarity and one-ring rotations. Where the image shows no edge, the shape decides. No triangle
/// turns. Deviates from Eq. 2 in the weights, and in a second force that keeps vertices at P⁰ where `strength` is
/// below 1. Errors: the mesh lies outside the image; the image is the same everywhere around it; cancelled.
Result<SnapResult> snap(const Volume& image, int frame, const SnapStart& start, const SnapOptions& options);

/// The allowed shape that is nearest to the boundary that an image shows, beginning with the mean under `placement`. A
/// snap from there goes beyond it. Errors: those of snap().
Result<AllowedFit> snap_allowed(const Volume& image, int frame, const AllowedShapes& allowed,
                                const std::shared_ptr<const Topology>& topology, const Similarity& placement,
                                const SnapOptions& options);

}  // namespace homolog
