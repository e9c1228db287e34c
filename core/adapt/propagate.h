#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/base/result.h"
#include "core/mesh/topology.h"
#include "core/volume/volume.h"

namespace homolog {

struct PropagateOptions {
  double reach_mm = 6;          ///< how far the boundary may move from one frame to the next
  std::map<int, Points> known;  ///< meshes of further frames that are right (n×3, LPS mm): they stay as they are
  /// The share of the label that the meshes lack. If they lack some, every frame is in doubt.
  double missing_share = 0;
  Progress* progress = nullptr;
};

/// One frame's mesh, and how far it is to be trusted.
struct PropagatedFrame {
  Points points;
  double volume_ml = 0;
  double confidence = 0;  ///< 0…1: how similar the image along the boundary is to that of the given frame
  /// Mean distance between the vertices that came forwards and those that came backwards, from one known frame to the
  /// next or round a whole cycle; beyond the last known frame of a cine that is no closed cycle there is none.
  std::optional<double> disagreement_mm;
  std::string doubt;  ///< why a person has to look at it, as a sentence; empty where the frame is not in doubt
};

/// How far a volume curve goes down.
struct Ejection {
  int end_diastole = 0, end_systole = 0;  ///< frames of the largest and the smallest volume
  double fraction = 0;                    ///< (largest − smallest) / largest
};
/// Returns the ejection that volumes (ml) by frame tell of; none where there are no volumes.
std::optional<Ejection> ejection_of(const std::map<int, double>& volumes_ml);

struct Propagation {
  std::vector<PropagatedFrame> frames;
  std::vector<int> known;  ///< the frames whose meshes were given
  bool cycle = false;      ///< the last frame leads on to the first, by the images or by the volumes
  Ejection ejection;       ///< doubtful frames left out; of all where all are in doubt
};

/// The doubt about a mesh that lacks a share of its label, as PropagatedFrame::doubt.
std::string missing_doubt(double missing_share);

/// Carries the mesh of one frame through all frames of a cine, in both directions: each frame starts from the one
/// before and snaps to where the image looks along the normals as it does in the known frame that it came from. Between
/// two known frames, and around a closed cycle, both ways meet in every frame and are blended, the shorter way counting
/// more. A frame that shows nothing of the kind gets the mean of its neighbours and a doubt. Known frames stay as they
/// are. Errors: one frame only; a mesh lies outside the image, or has another number of vertices; cancelled.
Result<Propagation> propagate(const Volume& cine, int frame, const Mesh& mesh, const VertexScalars& stiffness,
                              const PropagateOptions& options = {});

}  // namespace homolog
