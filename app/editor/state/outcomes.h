#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/editor/state/settings.h"
#include "core/adapt/contours/contour_fit.h"
#include "core/adapt/judge_fit.h"
#include "core/case/actions/history_marks.h"
#include "core/case/actions/points.h"
#include "core/measure/compare.h"
#include "core/mesh/mesh_quality.h"

namespace homolog {

// The outcomes of the automatic steps.

/// A finished fit or refinement: the edit, and what it is judged by.
struct Fitted {
  SetPoints edit;
  FitFigures figures;     ///< a fit's figures; a refinement has the remarks alone
  bool doubtful = false;  ///< a fit that a person has to look at
};

/// The findings of a snap.
struct SnapFound {
  Points points;
  std::shared_ptr<const VertexScalars> confidence;  ///< per vertex, 0…1
  double mean_confidence = 0, moved_mm = 0, seconds = 0;
  bool doubtful = false;
  std::string held;     ///< "4 landmarks and 2 pulls": what the snap left where a person put it; empty: nothing
  bool told = false;    ///< `held` was said, or the edit was refused
  int strokes = 0;      ///< Shape::strokes with it: fewer where its edit was refused
  std::string warning;  ///< a sentence; empty where there is none

  bool is_of(const Points& shape) const { return shape.rows() == points.rows() && shape == points; }
};

/// The outcome of a fit to contours.
struct ContoursFitted {
  std::shared_ptr<const Points> points;                     ///< the points that it gave the mesh
  std::vector<std::shared_ptr<const ContourSet>> contours;  ///< the structure's contours, as they were
  ContourDistance off;                                      ///< how far the contours lie from it
  std::vector<std::string> warnings;                        ///< each a sentence
};

/// The making of a template as it stands, from the first stage to the finished mesh.
struct TemplateMaking {
  struct Stage {
    std::string name;
    std::shared_ptr<const Mesh> surface;
    double seconds = 0;  ///< since the start
  };
  TemplateSettings settings;
  std::string source;  ///< name of the label map
  FacedNames faced;    ///< the labels that a part faces, as fits to other maps find it
  std::vector<Stage> stages;
  bool done = false;
  // A finished one has these.
  std::optional<Mesh> mesh;
  std::vector<std::int32_t> cut;     ///< its vertices on the flat faces where the label map ends
  std::optional<double> closing_mm;  ///< chosen by trying, or as asked for
  MeshQuality quality;
  SurfaceDistance to_mask, from_mask;
  std::vector<std::string> remarks;  ///< warnings, and what was left out or filled, each a sentence
  double missing_share = 0;          ///< share of the label's volume that a tube lacks
  std::string missing;               ///< the sentence, where that is much
  std::string error;                 ///< the sentence, where it failed
};

}  // namespace homolog
