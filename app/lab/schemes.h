#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/adapt/boundary/boundary.h"
#include "core/experiment/scripted_user.h"
#include "core/phantom/phantom.h"

namespace homolog {

/// The use of the landmarks shown before the boundary is pulled.
enum class LandmarkUse {
  none,
  grab,  ///< each dragged to its place with a large σ
  warp,  ///< clicked: similarity and landmark warp
  hold   ///< warp, then a small region around each confirmed
};

/// The way that brings the template to the boundary.
enum class Adaptation {
  pulls,      ///< the scripted user
  fit,        ///< the automatic fit
  projection  ///< every vertex to the closest point, without Eq. 3: what a fit is measured against
};

/// A way of working: "anchored+warp".
struct WorkingScheme {
  std::string name;
  Adaptation adaptation = Adaptation::pulls;
  Scheme scheme = Scheme::anchored;
  int paper_events = 1;
  double even_spacing = 0;
  LandmarkUse features = LandmarkUse::none;
  bool refine = false;  ///< moves the vertices along the surface at the end
};

/// The scheme of a name: raw, paper-1, paper-10, anchored or spacing (anchored, spacing 1), alone or with +grab, +warp
/// or +hold, and each of these with +refine; fit, alone or with +warp; projection. Errors: another name.
Result<WorkingScheme> working_scheme(const std::string& name);
/// Names of the schemes that are compared unless others are asked for, with landmarks to show or without.
std::vector<std::string> compared_schemes(bool with_features);
/// How a person works who knows the editor: its defaults, and the refinement when the outline is right.
std::string default_scheme(bool with_features);
/// The same without the refinement: pulls alone, so that the case can be replayed by other schemes too.
std::string pulling_scheme(bool with_features);

/// An organ to adapt a template to. All LPS mm.
struct ExperimentSubject {
  std::string name;
  Mesh target;            ///< closed
  double visible_mm = 1;  ///< a voxel
  std::vector<Landmark> shown,
      hidden;                   ///< landmarks of the template's names: to work with, and to measure the error at
  std::optional<Points> truth;  ///< the place of every vertex: then the error is measured at all of them
};

/// A phantom: its label map on a 1 mm grid as target, all its landmarks shown, every vertex known.
ExperimentSubject phantom_experiment_subject(Organ organ, int number);

/// The result of a run. Lengths in mm; landmark errors are means, absent where nothing is known.
struct SchemeRun {
  std::optional<double> landmarks_placed, landmarks_after_features, landmarks;
  double assd_placed = 0, assd = 0, hd95 = 0, dice = 0;
  int feature_strokes = 0, pulls = 0;
  std::optional<int> pulls_to_1mm;  ///< until the mean distance is at most 1 mm and Dice at least 0.95
  double edge_spread = 0;           ///< deviation/mean of edge length ÷ the reference's, over the edges
  double min_angle_deg = 0;
  std::size_t turned_triangles = 0;
  Points points;
};

struct SchemeRunOptions {
  std::optional<std::uint64_t> seed;  ///< the seed of the placement's disturbance; none without
  int most_pulls = 40;
  Progress* progress = nullptr;
};

/// One scheme at work: placement, features, pulls of the scripted user [docs/lab.md], or an adaptation without a
/// hand. `session` is new and has the template. Openings of the mesh are capped flat for surface distances and Dice.
/// Errors: the session's; cancelled.
Result<SchemeRun> run_scheme(EditSession& session, const ExperimentSubject& subject, const WorkingScheme& scheme,
                             const SchemeRunOptions& options);

}  // namespace homolog
