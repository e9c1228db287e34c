#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/processes/progress.h"
#include "core/measure/compare.h"
#include "core/template_making/tunnels.h"
#include "core/volume/volume.h"

namespace homolog {

/// The rule for tunnels through the organ.
struct GenusRule {
  enum class Kind {
    automatic,  ///< tunnels narrower than 0.035 of the size or than two edges are cut; a vertebral canal stays
    keep,       ///< every tunnel stays
    number      ///< the narrowest are cut until `genus` are left
  };
  Kind kind = Kind::automatic;
  int genus = 0;
};

struct MaskTemplateOptions {
  int label = 1;
  int frame = 0;
  int vertices = 2500;
  std::optional<double> closing_mm, opening_mm;  ///< radii of the balls; 0: none; without: ball_share of the size
  GenusRule genus;
  bool severs = true;  ///< tunnels are opened too, where the strand around them is thin; false: only filled
};

/// The steps of the making, in turn.
enum class TemplateStage { resampled, closed, opened, smoothed, tunnels_cut, remeshed };
const char* stage_name(TemplateStage stage);
/// Called after each step with its surface (LPS mm), on the thread that makes the template.
using ShowStage = std::function<void(TemplateStage stage, const Mesh& surface)>;

struct MaskTemplate {
  Mesh mesh;                  ///< closed, one component, outward oriented, numbered breadth-first; LPS mm
  SurfaceDistance to_mask;    ///< distance from the mesh to the boundary of the label's largest part, cavities filled
  SurfaceDistance from_mask;  ///< and back, so that what the mesh misses is seen too
  std::vector<CutTunnel> tunnels;  ///< the tunnels that were cut
  std::vector<double> islands_ml;  ///< parts left out, the largest first
  int cavities = 0;                ///< filled
  double cavities_ml = 0;
  /// The amount of the label's largest part that lies outside of the mesh and farther than two voxels from it: thin
  /// parts that the mesh does not have.
  double missed_ml = 0, missed_share = 0;
  double resampled_mm = 0;                ///< voxel size that was worked on
  double closing_mm = 0, opening_mm = 0;  ///< radii that were used
  std::vector<std::int32_t> cut;          ///< vertices where the label map ends and the organ is closed flat
  std::vector<std::string> warnings;      ///< each a sentence
};

/// A reference mesh of a complex organ from a label of a label map [Erdt 2009, §2.1; docs/templates.md]: signed
/// distances resampled evenly, closed, opened, smoothed, tunnels cut, marching cubes, vertices spread evenly and
/// projected back. If walls of an organ that is thin as a whole, such as thin bone, get lost or meet by that, they
/// are made as thick as the mesh can show [solid_voxels.h] instead, and nothing is opened, with a warning.
/// The grids that are worked on hold about 16 million voxels at most. Errors: the label does not occur,
/// vanishes in the opening, has fewer tunnels than asked for, or needs more vertices; cancelled.
Result<MaskTemplate> make_mask_template(const Volume& mask, const MaskTemplateOptions& options,
                                        Progress* progress = nullptr, const ShowStage& show = {});

/// The same shape renumbered breadth-first from the vertex that lies farthest up (superior).
Mesh renumbered_from_top(const Mesh& mesh);

}  // namespace homolog
