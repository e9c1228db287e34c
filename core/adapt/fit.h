#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/adapt/allowed_shapes.h"
#include "core/adapt/boundary/boundary.h"
#include "core/adapt/boundary/find_placement.h"
#include "core/base/processes/progress.h"
#include "core/template/template.h"

namespace homolog {

struct FitOptions {
  std::optional<Similarity> placement;    ///< the start; found where absent
  std::map<std::string, Vec3> landmarks;  ///< named places on the organ, LPS mm; others' names are left out
  Orientation orientation = Orientation::patient;
  /// The boundary may lack parts of the organ, or have what is not the organ's: see FitResult::outliers.
  bool partial = false;
  /// One way onto the boundary alone, without doubt or a look for mirror images: a fit in a quarter of the time, for a
  /// mean of many whose parts nobody looks at. Not for partial fits. A fit to contours then goes without doubt and
  /// without what is wrong with the mesh, while somebody draws.
  bool rough = false;
  bool has_side = true;                          ///< else it is its own mirror image, and never looks mirrored
  std::shared_ptr<const AllowedShapes> allowed;  ///< shapes to look among first; null: any
  Progress* progress = nullptr;
  /// Called after each step with the shape so far, on the thread that fits.
  std::function<void(const Points&)> show;
  bool stays = false;  ///< a fit to contours takes `placement` for where the organ lies, and does not look for it
};

struct FitResult {
  Similarity placement;  ///< the template's placement: the similarity nearest to the fitted shape
  Mesh mesh;             ///< in the template's numbering, LPS mm
  /// Per vertex: the root mean square distance (mm, in 3D) from where it is to where it might belong [fit_doubt_mm].
  /// About nine in ten experts' landmarks lie within 1.44 times this (docs/correspondence.md).
  VertexScalars doubt_mm;
  Points allowed;                    ///< the nearest of the allowed shapes (n×3); empty where any was allowed
  std::vector<Landmark> landmarks;   ///< the template's, carried along on the surface
  std::vector<std::int32_t> unseen;  ///< vertices beyond the scan's border, where the shape follows the template
  /// Vertices whose places the boundary lacks, as a partial fit finds them, in rising order. The shape follows the
  /// template there.
  std::vector<std::int32_t> outliers;
  std::vector<ScanBorder> template_cuts;  ///< cuts of the template, as it lies in the end [cut_borders]
  bool mirrored = false;                  ///< the template's mirror image fits clearly better [other_lie]
  bool half_turned = false;               ///< not that, but the template turned from RAS to LPS does [other_lie]
  std::size_t turned_triangles = 0, self_intersections = 0;
  std::vector<std::string> believed;  ///< names of the landmarks given that pulled on the mesh
  std::size_t landmarks_used = 0;     ///< how many these are
  bool landmarks_place = false;       ///< three or more were used, so that they had a say in the placement too
  std::vector<std::string> warnings;  ///< each a sentence
};

/// Returns n values, one a vertex: 1 where it is an outlier, else 0.
VertexScalars outlier_marks(const FitResult& fit);

/// Whether a template can be fitted with these options: also ones that a program put together. Errors: those of
/// check_template; a landmark or a placement that is not finite; allowed shapes of another mesh.
Result<void> check_arguments(const Template& the_template, const FitOptions& options);

/// Adapts a template to a boundary without a hand: placed by a similarity, then annealed [annealing.h] with force
/// targets on the boundary in both directions and on the landmarks; at the end vertices on the boundary, spread as in
/// the reference as far as that allows, and freed of turned triangles and of faces that meet as far as `untangle` can
/// (FitResult counts what is left). Deviates from Eq. 2
/// [Erdt 2009, §2.2]: where the boundary is not known the force has next to no weight and the shape decides.
/// With `allowed` shapes the nearest of them comes first [fit_allowed] and is the reference of what follows; the result
/// lies on the way from there to the boundary, as far as `beyond` says.
/// Errors: those of check_arguments and check_boundary; both have rims, but not as many; the placement given does not
/// reach the boundary; a template or a boundary that is flat or has no size; cancelled.
Result<FitResult> fit_to_boundary(const Template& the_template, const Boundary& boundary,
                                  const FitOptions& options = {});

}  // namespace homolog
